#include "constraints/bond_graph.hpp"

#include <algorithm>
#include <numeric>

namespace taut {

std::vector<std::vector<int>> bonds_at_atoms(int atoms, std::span<const RigidBond> bonds) {
  std::vector<std::vector<int>> bonds_at(atoms);
  for (int k = 0; k < static_cast<int>(bonds.size()); ++k) {
    bonds_at[bonds[k].i].push_back(k);
    bonds_at[bonds[k].j].push_back(k);
  }
  return bonds_at;
}

std::vector<int> connected_components(int n, const std::vector<IndexPair>& pairs) {
  std::vector<int> root(n);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int a) {
    while (root[a] != a) a = root[a] = root[root[a]];
    return a;
  };
  for (const auto& [a, b] : pairs) {
    const auto [low, high] = std::minmax({find(a), find(b)});
    root[high] = low;
  }
  for (int a = 0; a < n; ++a) root[a] = find(a);
  return root;
}

Couplings::Couplings(const System& sys)
    : Couplings(sys.bonds, {sys.inv_mass.data(), static_cast<std::size_t>(sys.atoms())}) {}

Couplings::Couplings(std::span<const RigidBond> bonds, std::span<const double> inv_mass)
    : reduced_inv_mass(bonds.size()) {
  for (std::size_t k = 0; k < bonds.size(); ++k)
    reduced_inv_mass[k] = inv_mass[bonds[k].i] + inv_mass[bonds[k].j];
  const auto bonds_at = bonds_at_atoms(static_cast<int>(inv_mass.size()), bonds);
  for (int a = 0; a < static_cast<int>(inv_mass.size()); ++a) {
    if (inv_mass[a] == 0) continue;
    for (auto k = bonds_at[a].begin(); k != bonds_at[a].end(); ++k)
      for (auto l = k + 1; l != bonds_at[a].end(); ++l) {
        const bool same_end = (bonds[*k].i == a) == (bonds[*l].i == a);
        pairs.push_back({*k, *l});
        signed_inv_mass.push_back(same_end ? inv_mass[a] : -inv_mass[a]);
      }
  }
}

}  // namespace taut
