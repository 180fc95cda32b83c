#pragma once

#include <hwy/base.h>

#include <Eigen/Core>
#include <algorithm>
#include <concepts>
#include <cstddef>
#include <new>
#include <vector>

#include "base/archive.hpp"
#include "base/threads.hpp"
#include "constraints/batch/bond_clusters.hpp"
#include "constraints/elimination.hpp"
#include "md/solve_stats.hpp"

namespace taut {

// Equal clusters side by side: cluster 8g + l of a batch is lane l of its group g. A row is one number of
// each of a group's clusters; rows of a group follow each other in memory. Machines with narrower vectors
// take a group in parts.
inline constexpr int kLanes = 8;

// What a kernel needs for one part, handed out piece by piece.
struct Scratch {
  double *next, *end;

  HWY_INLINE double* take(int rows) {
    double* taken = next;
    next += rows * kLanes;
    HWY_ASSERT(next <= end);
    return taken;
  }
};
// As many as any kernel takes.
constexpr int scratch_rows(int atoms, int bonds, int entries) {
  return 9 * atoms + 9 * bonds + 2 * entries;
}

// A bond as the kernels want it.
struct LaneBond {
  std::ptrdiff_t i, j;  // where its atoms' rows begin, from the first row of a 3 × atoms array
  double inv_mass_i, inv_mass_j;
  double reduced_inv_mass;  // 1/m_i + 1/m_j
  double length2;           // d²
  double half_inv_length2;  // 1/(2d²)
  double least_pivot;       // below it the bond depends on others
};

// A batch, its bonds in the order they are worked on.
struct LaneBatch {
  explicit LaneBatch(const ClusterBatch& batch);
  LaneBatch(const ClusterBatch& batch, Elimination plan);

  Elimination plan;  // rows and updates as places of rows: × kLanes
  int atoms, clusters, groups;
  std::vector<double> inv_mass;  // atoms
  std::vector<LaneBond> bonds;   // in the order of elimination
  // Of each group and lane: 3 × the first atom, where every cluster's atoms follow each other; else 3 × each
  // atom, [group][atom][lane]. Lanes left over in the last group repeat the last cluster.
  bool contiguous;
  bool ascending;  // contiguous, each cluster after the one before
  bool chain;      // column k has one entry, k, and nothing is updated twice
  bool triangle;   // bonds 0–1, 0–2, 1–2
  std::vector<int> place;
  std::vector<int> bond_index;  // [group][bond][lane], as the system numbers them

  int left, right;  // of a piece: so many of its first and last atoms are its neighbours'

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

// Numbers at an address that any lane width can load from; copied as a value, as a method is.
template <class T>
struct LaneAllocator {
  using value_type = T;
  static constexpr std::align_val_t kAlignment{64};

  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), kAlignment)); }
  void deallocate(T* rows, std::size_t) { ::operator delete(rows, kAlignment); }
  bool operator==(const LaneAllocator&) const { return true; }
};
using AlignedDoubles = std::vector<double, LaneAllocator<double>>;

// Rows kept from step to step, so many for each group of each batch.
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
  AlignedDoubles rows_;
  std::size_t size_of_group_ = 0;
};

inline LaneRows rows_of_bonds(const LaneBatch& batch) {
  return {batch.groups, batch.bond_count()};
}

// Scatters one row a bond of every group to a number a bond of the system.
void rows_to_bonds(const LaneBatch& batch, const LaneRows& rows, Eigen::Ref<Eigen::VectorXd> values);
// ... and back, lanes left over and what a piece sees of its neighbours included.
void rows_from_bonds(const LaneBatch& batch, const Eigen::Ref<const Eigen::VectorXd>& values, LaneRows& rows);

// Where in a group's scratch the system of equations lies, what every solving method begins with: the first
// row of each part.
struct SystemRows {
  explicit SystemRows(const LaneBatch& batch) : SystemRows(batch.bond_count(), batch.plan.entries()) {}
  constexpr SystemRows(int bonds, int entries)
      : b(0), d(bonds), inv_d(2 * bonds), l(3 * bonds), u(l + entries), end(u + entries) {}
  int b, d, inv_d, l, u, end;
};

// Splits groups of several batches over threads and gives each thread scratch of its own.
class LaneRunner {
 public:
  void add(const LaneBatch& batch);

  // work(batch, group begin, group end, scratch) → SolveStats; the worst of them all is returned, and the
  // most iterations.
  template <class Work>
  SolveStats run(const Work& work) {
    const int threads = static_cast<int>(
        std::clamp(work_before_.back() / kBondsOfThread, 1L, static_cast<long>(available_threads())));
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
  static constexpr long kBondsOfThread = 480;  // fewer are not worth waking a thread for

  int share(int t, int threads) const;  // the first group of thread t
  void reserve(int threads);

  // Before each batch, and after the last: how many groups, and lanes × bonds.
  std::vector<int> first_group_ = {0};
  std::vector<long> work_before_ = {0};
  int scratch_rows_ = 0;
  std::vector<AlignedDoubles> scratch_;  // a thread each
  std::vector<SolveStats> stats_;
};

// All batches of a method. A Batch has `lanes`, `lambda` and what else the method keeps of it.
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

  // kernel(batch, step, …, group begin, group end, scratch) → SolveStats
  template <class Kernel, class... Asked>
  SolveStats run(Kernel& kernel, const Asked&... asked) {
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
