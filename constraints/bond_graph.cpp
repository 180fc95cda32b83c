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

std::vector<std::vector<int>> bonds_at_atoms(const System& sys) {
  if (sys.bearers.empty()) return bonds_at_atoms(sys.atoms(), sys.bonds);
  std::vector<std::vector<int>> bonds_at(sys.atoms());
  for (int k = 0; k < sys.bond_count(); ++k)
    sys.for_each_bearer(sys.bonds[k], [&](int a, double) {
      if (bonds_at[a].empty() || bonds_at[a].back() != k) bonds_at[a].push_back(k);
    });
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
  std::vector<int> mobile;  // an atom of each bond
  for (const RigidBond& bond : sys.bonds) {
    int before = -1;
    sys.for_each_bearer(bond, [&](int a, double) {
      if (sys.inv_mass[a] == 0) return;
      if (before >= 0) tied.push_back({before, a});
      before = a;
    });
    mobile.push_back(before);
  }
  const std::vector<int> of_atom = connected_components(sys.atoms(), tied);
  for (int& of_bond : mobile) of_bond = of_atom[of_bond];
  return mobile;
}

std::map<int, std::vector<int>> bonds_of_clusters(const System& sys) {
  const std::vector<int> cluster = clusters_of_bonds(sys);
  std::map<int, std::vector<int>> bonds;
  for (int k = 0; k < sys.bond_count(); ++k) bonds[cluster[k]].push_back(k);
  return bonds;
}

Couplings::Couplings(const System& sys) : reduced_inv_mass(sys.bond_count()) {
  couple(bonds_at_atoms(sys), {sys.inv_mass.data(), static_cast<std::size_t>(sys.atoms())},
         [&](int k, int a) {
           double sum = 0;
           sys.for_each_bearer(sys.bonds[k], [&](int b, double c) { sum += b == a ? c : 0; });
           return sum;
         });
}

Couplings::Couplings(std::span<const RigidBond> bonds, std::span<const double> inv_mass)
    : reduced_inv_mass(bonds.size()) {
  couple(bonds_at_atoms(static_cast<int>(inv_mass.size()), bonds), inv_mass,
         [&](int k, int a) { return bonds[k].i == a ? -1.0 : 1.0; });
}

void Couplings::couple(const std::vector<std::vector<int>>& bonds_at, std::span<const double> inv_mass,
                       const auto& weight) {
  reduced_inv_mass.setZero();
  for (int a = 0; a < static_cast<int>(inv_mass.size()); ++a) {
    if (inv_mass[a] == 0) continue;
    for (auto k = bonds_at[a].begin(); k != bonds_at[a].end(); ++k) {
      const double c = weight(*k, a);
      reduced_inv_mass[*k] += c * c * inv_mass[a];
      for (auto l = k + 1; l != bonds_at[a].end(); ++l) {
        pairs.push_back({*k, *l});
        signed_inv_mass.push_back(c * weight(*l, a) * inv_mass[a]);
      }
    }
  }
}

}  // namespace taut
