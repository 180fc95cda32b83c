#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "forcefield/clusters/aligned.hpp"
#include "forcefield/clusters/pair_kernels.hpp"
#include "forcefield/clusters/prune_list.hpp"

namespace taut {

// Each thread adds to forces of its own, and they are added up in the threads' order. In space a thread
// reaches but some blocks of clusters: others it neither clears nor has added up.
template <class T>
class ThreadForces {
 public:
  void make_room(int threads, int clusters) {
    clusters_ = clusters;
    force_.resize(threads);
    reached_.resize(threads);
  }

  // What thread t reaches: nothing, then a list's rows.
  void forget(int t) {
    force_[t].resize(std::size_t(numbers_) * clusters_);
    reached_[t].assign(clusters_ / kBlock + 1, alone());
  }
  void reach(int t, const ClusterList& list, RowRange rows) {
    if (alone()) return;
    auto& reached = reached_[t];
    for (int r = rows.begin; r < rows.end; ++r) {
      const PairRow& row = list.rows[r];
      reached[row.first / kClusterAtoms / kBlock] = 1;
      for (int k = row.begin; k < row.end; ++k) reached[list.clusters[k] / kBlock] = 1;
      for (int k = row.masked_begin; k < row.masked_end; ++k) reached[list.masked[k].cluster / kBlock] = 1;
    }
  }

  // Thread t's, cleared: as add_pair_forces() has them.
  T* cleared(int t) {
    for (int b = 0; kBlock * b < clusters_; ++b)
      if (reached_[t][b]) {
        const int end = std::min(kBlock * (b + 1), clusters_);
        std::fill_n(of(t, kBlock * b), std::size_t(numbers_) * (end - kBlock * b), T(0));
      }
    return force_[t].data();
  }

  // A cluster's, of all threads and copies: x, y, z of its four.
  using Along = std::array<double, kClusterAtoms>;
  std::array<Along, 3> sum(int cluster) { return {sum(cluster, 0), sum(cluster, 1), sum(cluster, 2)}; }

 private:
  static constexpr int kBlock = 16;                  // clusters
  bool alone() const { return force_.size() == 1; }  // and reaches all
  // Four numbers at a time stay in registers; twelve would be cleared in memory by a slow instruction.
  Along sum(int cluster, int axis) {
    Along sum{};
    for (std::size_t t = 0; t < force_.size(); ++t) {
      if (!reached_[t][cluster / kBlock]) continue;
      const T* force = of(static_cast<int>(t), cluster) + axis * copies_ * kClusterAtoms;
      for (int copy = 0; copy < copies_; ++copy, force += kClusterAtoms)
        for (int i = 0; i < kClusterAtoms; ++i) sum[i] += double(force[i]);
    }
    return sum;
  }
  T* of(int t, int cluster) { return force_[t].data() + std::size_t(numbers_) * cluster; }

  const int copies_ = force_copies<T>();
  const int numbers_ = 3 * kClusterAtoms * copies_;  // of a cluster
  int clusters_ = 0;
  std::vector<Aligned<T>> force_;                   // by thread, as what follows
  std::vector<std::vector<std::uint8_t>> reached_;  // blocks
};

}  // namespace taut
