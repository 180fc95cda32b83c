#pragma once

#include <cstdint>
#include <vector>

#include "base/aligned.hpp"
#include "base/threads.hpp"
#include "forcefield/pairs/atom_clusters.hpp"
#include "forcefield/pairs/cluster_pairs.hpp"
#include "forcefield/pairs/pair_kernels.hpp"

namespace taut {

// What goes between atoms, in their own order, and slots, in that of clusters: of a share of the clusters.

// Positions: now[], as AtomTracks has them [nm], and to.x.
template <class T>
void place_atoms(const Vectors& x, const AtomClusters& clusters, const Share& share, double* now,
                 PairAtoms<T>& to);

// Forces as add_pair_forces() has them, of each thread, and where in space it has any.
template <class T>
struct SlotForces {
  static constexpr int kBlock = 16;                // clusters
  std::vector<Aligned<T>> force;                   // by thread, as what follows
  std::vector<std::vector<std::uint8_t>> reached;  // blocks
};

struct HandOut {
  double unit;  // of them
  ClusterPairs::Onto onto;
};

// All of them added up, copy by copy and thread by thread.
template <class T>
void hand_out(const SlotForces<T>& from, const AtomClusters& clusters, const Share& share, const HandOut& how,
              Vectors& f);

}  // namespace taut
