#include "forcefield/clusters/pair_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/clusters/prune_list.cpp"
#include "forcefield/clusters/simd_targets.hpp"
// after the targets: once a target
#include "forcefield/clusters/in_range-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

// Cuts a row of four into rows of `atoms`, each with the clusters that hold a pair in range with it.
void prune_rows(const FixedPositions& x, const std::vector<std::uint8_t>& kind, const ClusterList& list,
                double range, int atoms, ClusterList& pruned) {
  const int rows = kClusterAtoms / atoms, all = 1 << (4 * atoms);
  pruned.rows.clear();
  pruned.masked.clear();
  pruned.clusters.resize(rows * list.clusters.size());  // room
  InRange in_range(x, range);
  int* next = pruned.clusters.data();
  for (const PairRow& whole : list.rows) {
    in_range.take(whole.first / kClusterAtoms, whole.shift);
    // The rows' clusters, in places far enough from each other.
    const int room = whole.end - whole.begin;
    int* first = next;
    int* second = next + room;
    const unsigned half = static_cast<unsigned>(all - 1);
    for (int k = whole.begin; k < whole.end; ++k) {
      const unsigned bits = in_range.with(list.clusters[k]);
      *first = list.clusters[k];
      first += (bits & half) != 0;
      if (rows == 1) continue;
      *second = list.clusters[k];
      second += (bits & ~half) != 0;
    }
    int* ends[] = {first, second};
    for (int r = 0; r < rows; ++r) {
      PairRow row{};
      row.first = whole.first + r * atoms;
      row.shift = whole.shift;
      for (int i = 0; i < atoms; ++i) row.kind |= kind[row.first + i];
      int* begin = r == 0 ? next : next + (r * room);
      row.begin = static_cast<int>(begin - pruned.clusters.data());
      row.end = static_cast<int>(ends[r] - pruned.clusters.data());
      row.masked_begin = static_cast<int>(pruned.masked.size());
      for (int k = whole.masked_begin; k < whole.masked_end; ++k) {
        const unsigned mask = list.masked[k].mask >> (4 * atoms * r) & half;
        if (mask != 0) pruned.masked.push_back({list.masked[k].cluster, mask});
      }
      row.masked_end = static_cast<int>(pruned.masked.size());
      if (row.end > row.begin || row.masked_end > row.masked_begin) pruned.rows.push_back(row);
    }
    next = rows == 1 ? first : second;
  }
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(prune_rows);
void prune_list(const FixedPositions& x, const std::vector<std::uint8_t>& kind, const ClusterList& list,
                double range, int row_atoms, ClusterList& pruned) {
  HWY_DYNAMIC_DISPATCH(prune_rows)(x, kind, list, range, row_atoms, pruned);
}

}  // namespace taut
#endif
