#pragma once

#include <vector>

#include "md/system.hpp"

namespace taut {

// What equal clusters have in common; atoms and bonds are numbered within the cluster, in the system's order.
struct ClusterShape {
  std::vector<RigidBond> bonds;  // i < j
  std::vector<double> inv_mass;  // [1/u], atoms

  int atoms() const { return static_cast<int>(inv_mass.size()); }
  int bond_count() const { return static_cast<int>(bonds.size()); }
  double reduced_inv_mass(int k) const { return inv_mass[bonds[k].i] + inv_mass[bonds[k].j]; }
};

// Clusters of one shape.
struct ClusterBatch {
  ClusterShape shape;
  int count = 0;
  std::vector<int> atoms;  // [cluster][atom], as the system numbers them
  std::vector<int> bonds;  // [cluster][bond]
};

// The bonds of a system by clusters: atoms tied together, directly or by way of others that can move.
// Clusters that match bond for bond, masses and lengths included, form a batch. They share no atom, so that
// they can be worked on side by side.
struct BondClusters {
  std::vector<ClusterBatch> batches;
  std::vector<int> rest;  // bonds of clusters with an anchored atom, or larger than the limits allow
};

struct ClusterLimits {
  int most_bonds = 200;          // of a cluster
  int most_bonds_alike = 20000;  // where there are `alike` or more of one shape
  int alike = 4;
};

BondClusters find_clusters(const System& sys, const ClusterLimits& limits = {});

}  // namespace taut
