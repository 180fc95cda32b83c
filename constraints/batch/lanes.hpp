#pragma once

#include <hwy/base.h>

#include <Eigen/Core>
#include <algorithm>
#include <concepts>
#include <cstddef>
#include <vector>

#include "base/aligned.hpp"
#include "base/archive.hpp"
#include "base/threads.hpp"
#include "constraints/batch/bond_clusters.hpp"
#include "constraints/elimination.hpp"
#include "md/solve_stats.hpp"

namespace taut {

// Equal clusters are solved side by side: cluster 8g + l of a batch is lane l of its group g. A row holds one
// number of each cluster of a group, and the rows of a group are contiguous in memory. Targets with narrower
// vectors process a group in parts.
inline constexpr int kLanes = 8;

// Working memory of a kernel for one part, handed out in rows.
struct Scratch {
  double *next, *end;

  HWY_INLINE double* take(int rows) {
    double* taken = next;
    next += rows * kLanes;
    HWY_ASSERT(next <= end);
    return taken;
  }
};
// The most rows that any kernel takes.
constexpr int scratch_rows(int atoms, int bonds, int entries) {
  return 9 * atoms + 10 * bonds + 2 * entries;
}

// The constants of a bond that kernels read.
struct LaneBond {
  std::ptrdiff_t i, j;  // offsets of its atoms' rows in a 3 × atoms array
  double inv_mass_i, inv_mass_j;
  double reduced_inv_mass;  // 1/m_i + 1/m_j
  double length2;           // d²
  double half_inv_length2;  // 1/(2d²)
  double least_pivot;       // a smaller pivot means that the bond depends on others
};

// A batch, with its bonds in the order of elimination.
struct LaneBatch {
  explicit LaneBatch(const ClusterBatch& batch);
  LaneBatch(const ClusterBatch& batch, Elimination plan);

  Elimination plan;  // row and update are offsets of rows (× kLanes)
  int atoms, clusters, groups;
  std::vector<double> inv_mass;  // atoms
  std::vector<LaneBond> bonds;   // in the order of elimination
  // If every cluster's atoms are contiguous: 3 × the first atom, [group][lane]; else 3 × each atom,
  // [group][atom][lane]. Unused lanes of the last group repeat the last cluster.
  bool contiguous;
  bool ascending;  // contiguous, and each cluster follows the one before it
  bool chain;      // column k has one entry, k, and elimination makes no fill
  bool triangle;   // bonds 0–1, 0–2, 1–2
  std::vector<int> place;
  std::vector<int> bond_index;  // [group][bond][lane], as the system numbers them

  int left, right;  // a piece's numbers of atoms that belong to its neighbours

  int bond_count() const { return static_cast<int>(bonds.size()); }
  bool piece() const { return left + right > 0; }
  int filled(int group) const { return std::min(kLanes, clusters - group * kLanes); }
  const int* places(int group) const {
    return place.data() + std::ptrdiff_t{group} * kLanes * (contiguous ? 1 : atoms);
  }
  int bond(int group, int k, int lane) const {
    return bond_index[(group * bonds.size() + k) * kLanes + lane];
  }
  int scratch_rows() const { return taut::scratch_rows(atoms, bond_count(), plan.entries()); }
};

// Rows that a batch keeps from step to step, the same number for each group.
class LaneRows {
 public:
  LaneRows() = default;
  LaneRows(int groups, int rows_of_group);  // zeros

  double* of(int group) { return rows_.data() + static_cast<std::size_t>(group) * size_of_group_; }
  const double* of(int group) const {
    return rows_.data() + static_cast<std::size_t>(group) * size_of_group_;
  }
  void swap(LaneRows& other) noexcept;
  void serialize(Archive& archive) { archive(rows_); }

 private:
  Aligned<double> rows_;
  std::size_t size_of_group_ = 0;
};

inline LaneRows rows_of_bonds(const LaneBatch& batch) {
  return {batch.groups, batch.bond_count()};
}

// Copies one row per bond of every group to one number per bond of the system.
void rows_to_bonds(const LaneBatch& batch, const LaneRows& rows, Eigen::Ref<Eigen::VectorXd> values);
// Copies them back, into unused lanes and into a piece's copies of its neighbours' bonds, too.
void rows_from_bonds(const LaneBatch& batch, const Eigen::Ref<const Eigen::VectorXd>& values, LaneRows& rows);

// The first rows in a group's scratch, with which every method that solves A g = b begins: b, and A as L D U with D and
// its inverse, l and u an entry for each coupling.
struct SystemRows {
  explicit SystemRows(const LaneBatch& batch) : SystemRows(batch.bond_count(), batch.plan.entries()) {}
  constexpr SystemRows(int bonds, int entries)
      : b(0), d(bonds), inv_d(2 * bonds), l(3 * bonds), u(l + entries), end(u + entries) {}
  int b, d, inv_d, l, u, end;
};

// Divides the groups of several batches among threads, and gives each thread its own scratch.
class LaneRunner {
 public:
  void add(const LaneBatch& batch);

  // Calls work(batch, group begin, group end, scratch) → SolveStats. Returns the largest residual, with its
  // bond, and the most iterations.
  template <class Work>
  SolveStats run(const Work& work) {
    const int threads =
        static_cast<int>(std::clamp(bonds_ / kBondsOfThread, 1L, static_cast<long>(available_threads())));
    reserve(threads);
    in_parallel(threads, [&](int t) {
      SolveStats stats;
      const int begin = share(t, threads), end = share(t + 1, threads);
      for (std::size_t b = 0; b + 1 < first_group_.size(); ++b) {
        const int from = std::max(begin, first_group_[b]), to = std::min(end, first_group_[b + 1]);
        if (from < to)
          stats.beside(work(static_cast<int>(b), from - first_group_[b], to - first_group_[b],
                            Scratch{scratch_[t].data(), scratch_[t].data() + scratch_[t].size()}));
      }
      stats_[t] = stats;
    });
    SolveStats all;
    for (int t = 0; t < threads; ++t) all.beside(stats_[t]);
    return all;
  }

 private:
  static constexpr long kBondsOfThread = 480;  // fewer do not pay for waking a thread

  int share(int t, int threads) const;  // first group of thread t
  void reserve(int threads);

  // Prefix sums over the batches: numbers of groups, and their work. lanes × bonds in all.
  std::vector<int> first_group_ = {0};
  std::vector<long> work_before_ = {0};
  long bonds_ = 0;
  int scratch_rows_ = 0;
  std::vector<Aligned<double>> scratch_;  // one per thread
  std::vector<SolveStats> stats_;
};

// All batches of a method. A Batch has `lanes`, `lambda` and further data of the method.
template <class Batch>
class LaneBatches {
 public:
  explicit LaneBatches(const std::vector<ClusterBatch>& batches) {
    if constexpr (std::constructible_from<Batch, const ClusterBatch&>)
      for (const ClusterBatch& batch : batches) add(batch);
  }
  explicit LaneBatches(const BondClusters& clusters) : LaneBatches(clusters.batches) {}

  template <class... Arguments>
  void add(const Arguments&... arguments) {
    runner_.add(batches_.emplace_back(arguments...).lanes);
  }

  // Calls kernel(batch, asked…, group begin, group end, scratch) → SolveStats for all groups, on threads.
  template <class Kernel, class... Asked>
  SolveStats run(const Kernel& kernel, const Asked&... asked) {
    return runner_.run([&](int b, int begin, int end, const Scratch& scratch) {
      return kernel(batches_[b], asked..., begin, end, scratch);
    });
  }

  auto begin() { return batches_.begin(); }
  auto end() { return batches_.end(); }
  auto begin() const { return batches_.begin(); }
  auto end() const { return batches_.end(); }
  bool empty() const { return batches_.empty(); }
  Batch& operator[](int b) { return batches_[b]; }

  void serialize(Archive& archive) { archive(batches_); }
  void write_lambda(Eigen::VectorXd& lambda) const {
    for (const Batch& batch : batches_) rows_to_bonds(batch.lanes, batch.lambda, lambda);
  }

 private:
  std::vector<Batch> batches_;
  LaneRunner runner_;
};

}  // namespace taut
