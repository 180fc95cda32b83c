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

std::vector<int> clusters_of_bonds(const System& sys) {
  std::vector<IndexPair> tied;
  for (const auto& [i, j, d] : sys.bonds)
    if (sys.inv_mass[i] != 0 && sys.inv_mass[j] != 0) tied.push_back({i, j});
  const std::vector<int> of_atom = connected_components(sys.atoms(), tied);
  std::vector<int> of_bond;
  for (const auto& [i, j, d] : sys.bonds) of_bond.push_back(of_atom[sys.inv_mass[i] == 0 ? j : i]);
  return of_bond;
}

std::map<int, std::vector<int>> bonds_of_clusters(const System& sys) {
  const std::vector<int> cluster = clusters_of_bonds(sys);
  std::map<int, std::vector<int>> bonds;
  for (int k = 0; k < sys.bond_count(); ++k) bonds[cluster[k]].push_back(k);
  return bonds;
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
