#pragma once

#include <algorithm>
#include <array>
#include <map>

#include "md/system.hpp"

namespace taut {

using BondsByAtoms = std::map<std::array<int, 2>, int>;

inline std::array<int, 2> in_order(int i, int j) {
  return {std::min(i, j), std::max(i, j)};
}

// The number of each rigid bond, by its two atoms in ascending order; the first of those between the same atoms.
inline BondsByAtoms bonds_by_atoms(const System& sys) {
  BondsByAtoms all;
  for (int k = 0; k < sys.bond_count(); ++k) all.try_emplace(in_order(sys.bonds[k].i, sys.bonds[k].j), k);
  return all;
}

}  // namespace taut
