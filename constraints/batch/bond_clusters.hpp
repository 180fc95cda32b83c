#pragma once

#include <vector>

#include "md/system.hpp"

namespace taut {

// The shape that equal clusters share. Atoms and bonds are numbered within the cluster, in the system's
// order. A piece of a chain (cut_chains.hpp) numbers them along the chain; its first `left` and last `right`
// atoms and bonds (two or none) belong to its neighbours.
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

// A piece of a chain is cluster `cluster` of batch `batch`.
struct PieceOfChain {
  int batch, cluster;
};

// The bonds of a system grouped by clusters: sets of atoms that bonds connect, directly or through other
// mobile atoms. Clusters with the same bonds, masses and lengths form a batch. Clusters share no atom, so
// that they can be solved side by side.
struct BondClusters {
  std::vector<ClusterBatch> batches;
  std::vector<ClusterBatch> pieces;               // of long chains
  std::vector<std::vector<PieceOfChain>> chains;  // the pieces of each cut chain, from end to end
  // Bonds of clusters with an anchored atom or a bond of a virtual site, through the box to their own image, or larger
  // than the limits allow.
  std::vector<int> rest;
};

struct ClusterLimits {
  int most_bonds = 200;          // of any cluster
  int most_bonds_alike = 20000;  // of a cluster of which there are `alike` or more
  int alike = 4;
  int piece = 0;  // longer chains are cut into pieces of about this many bonds; 0: not cut

  static ClusterLimits none_in_lanes() { return {.most_bonds = 0, .most_bonds_alike = 0}; }
  // Equal chains that nearly fill the lanes stay whole, since cutting costs half as much again. The number of
  // threads has no influence, so that a chain's bits do not depend on it.
  static ClusterLimits cutting() { return {.alike = 8, .piece = 150}; }
  bool fill_lanes(int count) const {
    const int filled = (count + alike - 1) / alike * alike;
    return piece == 0 || 2 * filled <= 3 * count;
  }
};

BondClusters find_clusters(const System& sys, const ClusterLimits& limits = {});

}  // namespace taut
