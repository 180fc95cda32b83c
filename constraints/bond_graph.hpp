#pragma once

#include <array>
#include <map>
#include <span>
#include <vector>

#include "md/system.hpp"

namespace taut {

using IndexPair = std::array<int, 2>;

// Returns the bonds of each atom, in ascending order: those that end in it, or that it bears.
std::vector<std::vector<int>> bonds_at_atoms(int atoms, std::span<const RigidBond> bonds);
std::vector<std::vector<int>> bonds_at_atoms(const System& sys);

// Returns, for each index, the smallest index of its connected component.
std::vector<int> connected_components(int n, const std::vector<IndexPair>& pairs);

// Returns, for each bond, the smallest mobile atom of its cluster. Anchors couple no bonds.
std::vector<int> clusters_of_bonds(const System& sys);

// The bonds of each cluster, by that atom.
std::map<int, std::vector<int>> bonds_of_clusters(const System& sys);

// Two bonds k and l are coupled if they share an atom a that can move. The coupling is +1/m_a if a is the
// same end (i or j) of both bonds, and −1/m_a otherwise; c_k c_l/m_a for the weights c of an atom that bears them
// (md/system.hpp). Bonds that share several atoms have a coupling for each, which add up.
struct Couplings {
  Couplings(std::span<const RigidBond> bonds, std::span<const double> inv_mass);
  explicit Couplings(const System& sys);
  explicit Couplings(int bonds) : reduced_inv_mass(bonds) {}  // without couplings

  std::vector<IndexPair> pairs;         // (k, l)
  std::vector<double> signed_inv_mass;  // [1/u]
  Eigen::VectorXd reduced_inv_mass;     // System::reduced_inv_mass, m

  int bond_count() const { return static_cast<int>(reduced_inv_mass.size()); }

 private:
  // weight(k, a): c of bond k at atom a
  void couple(const std::vector<std::vector<int>>& bonds_at, std::span<const double> inv_mass,
              const auto& weight);
};

}  // namespace taut
