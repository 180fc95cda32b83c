#include "systems/whole_molecules.hpp"

#include <fmt/format.h>

#include <set>

#include "base/adjacency.hpp"
#include "base/errors.hpp"

namespace taut {
namespace {

// Traverses every molecule from its first atom, and calls step(from, to) once for each further atom.
template <class Step>
std::vector<int> walk(int atoms, const std::vector<BondedPair>& pairs, Step step) {
  const Adjacency near(atoms, pairs);
  std::vector<int> molecule(atoms, -1);
  std::vector<int> open;
  int count = 0;
  for (int root = 0; root < atoms; ++root) {
    if (molecule[root] >= 0) continue;
    molecule[root] = count++;
    open.push_back(root);
    while (!open.empty()) {
      const int from = open.back();
      open.pop_back();
      for (int k = near.begin[from]; k < near.begin[from + 1]; ++k) {
        const int to = near.partner[k];
        if (molecule[to] >= 0) continue;
        molecule[to] = molecule[from];
        step(from, to);
        open.push_back(to);
      }
    }
  }
  return molecule;
}

}  // namespace

void tie_sites(const VirtualSites& sites, std::vector<BondedPair>& pairs) {
  for (const auto& site : sites) {
    const int first = site.parents.front().atom;
    pairs.push_back({first, site.atom});
    for (const auto& parent : site.parents)
      if (parent.atom != first) pairs.push_back({first, parent.atom});
  }
}

std::vector<BondedPair> bonded_pairs(const System& sys, const Terms& terms) {
  std::vector<BondedPair> pairs;
  pairs.reserve(sys.bonds.size() + terms.bonds.size() + terms.fene.size());
  for (const auto& b : sys.bonds) pairs.push_back({b.i, b.j});
  for (const auto& b : terms.bonds) pairs.push_back({b.i, b.j});
  for (const auto& b : terms.fene) pairs.push_back({b.i, b.j});
  for (const auto& b : terms.tabulated_bonds) pairs.push_back({b.i, b.j});
  tie_sites(sys.sites, pairs);
  return pairs;
}

std::vector<BondedPair> tied_pairs(const System& sys, const Terms& terms) {
  std::vector<BondedPair> pairs = bonded_pairs(sys, terms);
  for (const auto& b : sys.one_sided) pairs.push_back({b.i, b.j});
  return pairs;
}

std::vector<BondedPair> further_bonds(const System& sys, const Terms& terms) {
  std::set<std::pair<int, int>> ends;  // ends of Urey–Bradley springs
  for (const auto& angle : terms.angles) ends.insert(std::minmax(angle.i, angle.k));
  for (const auto& angle : terms.cosine_angles) ends.insert(std::minmax(angle.i, angle.k));
  for (const auto& angle : terms.cosine_squared_angles) ends.insert(std::minmax(angle.i, angle.k));
  for (const auto& angle : terms.tabulated_angles) ends.insert(std::minmax(angle.i, angle.k));
  std::vector<BondedPair> pairs;
  for (const auto& spring : terms.bonds)
    if (!ends.contains(std::minmax(spring.i, spring.j))) pairs.push_back({spring.i, spring.j});
  for (const auto& spring : terms.fene) pairs.push_back({spring.i, spring.j});
  for (const auto& bond : terms.tabulated_bonds) pairs.push_back({bond.i, bond.j});
  for (const auto& site : sys.sites) pairs.push_back({site.parents.front().atom, site.atom});
  return pairs;
}

std::vector<int> molecules(int atoms, const std::vector<BondedPair>& pairs) {
  return walk(atoms, pairs, [](int, int) {});
}

std::vector<int> molecules(const System& sys, const Terms& terms) {
  return molecules(sys.atoms(), tied_pairs(sys, terms));
}

Names guessed_names(const System& sys, const Terms& terms) {
  return guessed_names({sys.mass.begin(), sys.mass.end()}, molecules(sys, terms));
}

void make_whole(const Box& box, const std::vector<BondedPair>& pairs, Vectors& x) {
  if (!box.periodic()) return;
  walk(static_cast<int>(x.cols()), pairs, [&](int from, int to) {
    x.col(to) -= box.lattice_vector(box.cell_of(x.col(to) - x.col(from), std::round));
  });

  // Pairs that close a ring were not traversed. If such a pair is longer than half an edge by more than
  // rounding, the ring closes around the box.
  for (const auto& [i, j] : pairs) {
    const Vec3 d = x.col(j) - x.col(i);
    if (((d.cwiseQuotient(box.edge)).array().abs() > 0.5 + 1e-9).any())
      throw InputError(
          fmt::format("atoms {} and {} are bonded around the box: their molecule meets its own image", i, j));
  }
}

}  // namespace taut
