#pragma once

#include <cstdint>
#include <vector>

#include "base/aligned.hpp"
#include "base/threads.hpp"
#include "forcefield/pairs/atom_clusters.hpp"
#include "forcefield/pairs/cluster_pairs.hpp"
#include "forcefield/pairs/pair_kernels.hpp"

namespace taut {

// Copies between arrays by atom and arrays by slot (the order of the clusters), for a share of the clusters.

// Writes positions by slot: now[], in the layout of AtomTracks [nm], and to.x.
template <class T>
void place_atoms(const Vectors& x, const AtomClusters& clusters, const Share& share, double* now,
                 PairAtoms<T>& to);

// Force buffers of all threads in the layout of add_pair_forces(), and which blocks each thread has touched.
template <class T>
struct SlotForces {
  static constexpr int kBlock = 16;                // clusters
  std::vector<Aligned<T>> force;                   // by thread, as what follows
  std::vector<std::vector<std::uint8_t>> reached;  // blocks
};

struct Reduction {
  double unit;  // the buffers' forces are in kJ/mol/nm over this
  ClusterPairs::Write write;
};

// Adds up all buffers, copy by copy and thread by thread, into the forces by atom.
template <class T>
void reduce_forces(const SlotForces<T>& from, const AtomClusters& clusters, const Share& share,
                   const Reduction& how, Vectors& f);

}  // namespace taut
