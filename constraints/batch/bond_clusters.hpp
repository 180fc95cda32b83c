#pragma once

#include <vector>

#include "md/system.hpp"

namespace taut {

// What equal clusters have in common; atoms and bonds are numbered within the cluster, in the system's order.
// Those of a piece of a chain (cut_chains.hpp) go along the chain, and the first `left` and the last `right`
// of both, two or none, are what it sees of its neighbours.
struct ClusterShape {
  std::vector<RigidBond> bonds;  // i < j
  std::vector<double> inv_mass;  // [1/u], atoms
  int left = 0, right = 0;

  int atoms() const { return static_cast<int>(inv_mass.size()); }
  int bond_count() const { return static_cast<int>(bonds.size()); }
  bool piece() const { return left + right > 0; }
  double reduced_inv_mass(int k) const { return inv_mass[bonds[k].i] + inv_mass[bonds[k].j]; }
};

// Clusters of one shape.
struct ClusterBatch {
  ClusterShape shape;
  int count = 0;
  std::vector<int> atoms;  // [cluster][atom], as the system numbers them
  std::vector<int> bonds;  // [cluster][bond]
};

// Where a piece of a chain went: cluster `cluster` of batch `batch`.
struct PieceOfChain {
  int batch, cluster;
};

// The bonds of a system by clusters: atoms tied together, directly or by way of others that can move.
// Clusters that match bond for bond, masses and lengths included, form a batch. They share no atom, so that
// they can be worked on side by side.
struct BondClusters {
  std::vector<ClusterBatch> batches;
  std::vector<ClusterBatch> pieces;               // of long chains
  std::vector<std::vector<PieceOfChain>> chains;  // of each chain cut, its pieces from end to end
  std::vector<int> rest;  // bonds of clusters with an anchored atom, or larger than the limits allow
};

struct ClusterLimits {
  int most_bonds = 200;          // of a cluster
  int most_bonds_alike = 20000;  // where there are `alike` or more of one shape
  int alike = 4;
  int piece = 0;  // bonds of a piece, about, that longer chains are cut into; 0: they are not

  // Equal chains that all but fill the lanes stay whole: cutting costs half as much again. Threads have no
  // say: a chain's bits must not depend on how many there are.
  static ClusterLimits cutting() { return {.alike = 8, .piece = 150}; }
  bool fill_lanes(int count) const {
    const int filled = (count + alike - 1) / alike * alike;
    return piece == 0 || 2 * filled <= 3 * count;
  }
};

BondClusters find_clusters(const System& sys, const ClusterLimits& limits = {});

}  // namespace taut
