#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "forcefield/pairs/prune_list.hpp"
#include "forcefield/pairs/slots.hpp"

namespace taut {

// Each thread adds to a force buffer of its own; the buffers are added up in the order of the threads. A
// thread's rows touch only some blocks of clusters: the others are neither cleared nor added up.
template <class T>
class ThreadForces {
 public:
  void make_room(int threads, int clusters) {
    clusters_ = clusters;
    all_.force.resize(threads);
    all_.reached.resize(threads);
  }

  // Forgets which blocks thread t touches; mark_blocks() then marks those of a list's rows.
  void forget(int t) {
    all_.force[t].resize(std::size_t(numbers_) * clusters_);
    all_.reached[t].assign(clusters_ / kBlock + 1, alone());
  }
  void mark_blocks(int t, const ClusterList& list, RowRange rows) {
    if (alone()) return;
    auto& reached = all_.reached[t];
    for (int r = rows.begin; r < rows.end; ++r) {
      const PairRow& row = list.rows[r];
      reached[row.first / kClusterAtoms / kBlock] = 1;
      for (int k = row.begin; k < row.end; ++k) reached[list.clusters[k] / kBlock] = 1;
      for (int k = row.masked_begin; k < row.masked_end; ++k) reached[list.masked[k].cluster / kBlock] = 1;
    }
  }

  // Thread t's buffer, cleared, in the layout of add_pair_forces().
  T* cleared(int t) {
    for (int b = 0; kBlock * b < clusters_; ++b)
      if (all_.reached[t][b]) {
        const int end = std::min(kBlock * (b + 1), clusters_);
        std::fill_n(of(t, kBlock * b), std::size_t(numbers_) * (end - kBlock * b), T(0));
      }
    return all_.force[t].data();
  }

  const SlotForces<T>& all() const { return all_; }

 private:
  static constexpr int kBlock = SlotForces<T>::kBlock;
  bool alone() const { return all_.force.size() == 1; }  // one thread touches all blocks
  T* of(int t, int cluster) { return all_.force[t].data() + std::size_t(numbers_) * cluster; }

  const int numbers_ = 3 * kClusterAtoms * row_atoms<T>();  // of a cluster
  int clusters_ = 0;
  SlotForces<T> all_;
};

}  // namespace taut
