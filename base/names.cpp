#include "base/names.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

namespace taut {
namespace {

struct Element {
  std::string_view symbol;
  double mass;  // [u]
};

// Standard atomic weights, abridged (IUPAC 2021, doi:10.1515/pac-2019-0603), of what molecules are made of.
constexpr std::array kElements = {
    Element{"H", 1.008},   Element{"D", 2.014},   Element{"He", 4.0026}, Element{"Li", 6.94},
    Element{"B", 10.81},   Element{"C", 12.011},  Element{"N", 14.007},  Element{"O", 15.999},
    Element{"F", 18.998},  Element{"Ne", 20.18},  Element{"Na", 22.99},  Element{"Mg", 24.305},
    Element{"Al", 26.982}, Element{"Si", 28.085}, Element{"P", 30.974},  Element{"S", 32.06},
    Element{"Cl", 35.45},  Element{"Ar", 39.95},  Element{"K", 39.098},  Element{"Ca", 40.078},
    Element{"Fe", 55.845}, Element{"Cu", 63.546}, Element{"Zn", 65.38},  Element{"Br", 79.904},
    Element{"Kr", 83.798}, Element{"I", 126.9},   Element{"Xe", 131.29}};

std::string_view element_of(double mass) {
  for (const Element& e : kElements)
    if (std::abs(mass - e.mass) < 0.006) return e.symbol;
  return {};
}

// With up to two further sites, which have no element.
bool is_water(const std::vector<std::string_view>& elements) {
  const auto further = std::count(elements.begin(), elements.end(), "");
  return further <= 2 && std::ssize(elements) - further == 3 && elements[0] == "O" && elements[1] == "H" &&
         elements[2] == "H";
}

}  // namespace

Names repeated_names(const std::vector<AtomKind>& molecule, int copies) {
  Names names;
  std::vector<int> kind;
  std::map<AtomKind, int> known;
  for (const AtomKind& atom : molecule) {
    const auto [at, fresh] = known.try_emplace(atom, static_cast<int>(names.kinds.size()));
    if (fresh) names.kinds.push_back(atom);
    kind.push_back(at->second);
  }
  for (int m = 0; m < copies; ++m) {
    names.kind.insert(names.kind.end(), kind.begin(), kind.end());
    names.residue.insert(names.residue.end(), kind.size(), m);
  }
  return names;
}

Names guessed_names(const std::vector<double>& mass, const std::vector<int>& molecule) {
  std::map<int, std::vector<int>> members;
  for (int a = 0; a < static_cast<int>(mass.size()); ++a) members[molecule[a]].push_back(a);

  Names names;
  names.kind.resize(mass.size());
  names.residue.resize(mass.size());
  std::map<std::pair<std::string, std::string>, int> known;
  int residue = 0;
  for (const auto& [id, atoms] : members) {
    std::vector<std::string_view> elements;
    for (const int a : atoms) elements.push_back(element_of(mass[a]));
    const std::string name = is_water(elements) ? "HOH" : "MOL";
    std::map<std::string_view, int> count;
    for (std::size_t n = 0; n < atoms.size(); ++n) {
      std::string atom(elements[n].empty() ? "X" : elements[n]);
      const int number = ++count[elements[n]];
      if (!(name == "HOH" && atom == "O") && number < 1000) atom += std::to_string(number);
      const auto [at, fresh] = known.try_emplace({atom, name}, static_cast<int>(names.kinds.size()));
      if (fresh) names.kinds.push_back({atom, name, std::string(elements[n])});
      names.kind[atoms[n]] = at->second;
      names.residue[atoms[n]] = residue;
    }
    ++residue;
  }
  return names;
}

}  // namespace taut
