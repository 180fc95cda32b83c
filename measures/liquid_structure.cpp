#include "measures/liquid_structure.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "systems/molecules/whole_molecules.hpp"

namespace taut {
namespace {

// A system's molecules, and how many atoms each atom is bonded to.
struct Molecules {
  std::vector<std::vector<int>> atoms;
  std::vector<int> degree;

  Molecules(const System& sys, const Terms& terms) : degree(sys.atoms(), 0) {
    std::set<std::pair<int, int>> pairs;  // a site's parents may be bonded, too
    for (const auto& [i, j] : bonded_pairs(sys, terms))
      if (pairs.insert(std::minmax(i, j)).second) ++degree[i], ++degree[j];
    const std::vector<int> molecule = molecules(sys, terms);
    for (int a = 0; a < sys.atoms(); ++a) {
      atoms.resize(std::max<std::size_t>(atoms.size(), molecule[a] + 1));
      atoms[molecule[a]].push_back(a);
    }
  }
};

// The oxygen of a water, −1 for any other molecule: three atoms, each bonded to both others, one of 15 to 17
// u.
int oxygen_of(const std::vector<int>& atoms, const std::vector<int>& degree, const System& sys) {
  if (atoms.size() != 3) return -1;
  int oxygen = -1;
  for (const int a : atoms) {
    if (degree[a] != 2) return -1;
    if (sys.mass[a] > 15 && sys.mass[a] < 17) oxygen = a;
  }
  return oxygen;
}

// The two ends of an unbranched chain, none for any other molecule.
std::vector<int> ends_of(const std::vector<int>& atoms, const std::vector<int>& degree) {
  std::vector<int> ends;
  for (const int a : atoms) {
    if (degree[a] == 1) ends.push_back(a);
    if (degree[a] > 2) return {};
  }
  return atoms.size() > 2 && ends.size() == 2 ? ends : std::vector<int>{};
}

std::vector<int> oxygens(const System& sys, const Terms& terms, const Box& box) {
  const Molecules all(sys, terms);
  std::vector<int> oxygens;
  for (const auto& members : all.atoms)
    if (const int oxygen = oxygen_of(members, all.degree, sys); oxygen >= 0 && box.periodic())
      oxygens.push_back(oxygen);
  return oxygens;
}

}  // namespace

std::vector<std::array<int, 2>> chain_ends(const System& sys, const Terms& terms) {
  const Molecules all(sys, terms);
  std::vector<std::array<int, 2>> chains;
  for (const auto& members : all.atoms)
    if (const std::vector<int> ends = ends_of(members, all.degree); !ends.empty())
      chains.push_back({ends[0], ends[1]});
  return chains;
}

LiquidStructure::LiquidStructure(const System& sys, const Terms& terms, const Box& box)
    : oxygens_(oxygens(sys, terms, box), oxygens(sys, terms, box), molecules(sys, terms),
               std::min(1.0, box.edge.minCoeff() / 2)),
      chains_(chain_ends(sys, terms)) {}

void LiquidStructure::see(const State& s) {
  if (has_chains()) chains_.see(s.t, s.x);
  if (has_water()) oxygens_.see(s.t, s.x, s.box);
}

}  // namespace taut
