#include "forcefield/clusters/pair_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/clusters/prune_list.cpp"
#include "forcefield/clusters/simd_targets.hpp"
// after the targets: once a target
#include "forcefield/clusters/in_range-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

// What of a row's masks concerns the atoms from `first` on, 4 bits an atom.
void add_masks(const ClusterList& list, const PairRow& whole, int first, int atoms, PairRow& row,
               ClusterList& pruned) {
  row.masked_begin = static_cast<int>(pruned.masked.size());
  for (int k = whole.masked_begin; k < whole.masked_end; ++k) {
    const auto& [cluster, mask] = list.masked[k];
    const std::uint32_t part = (mask >> (4 * first)) & ((1u << (4 * atoms)) - 1);
    if (part != 0) pruned.masked.push_back({cluster, part});
  }
  row.masked_end = static_cast<int>(pruned.masked.size());
}

// Cuts a row of four into rows of `atoms`, four or two, each with the clusters that hold a pair in range with
// it.
void prune_rows(const RoundedPositions& x, const std::vector<std::uint8_t>& kind, const ClusterList& list,
                double range, int atoms, ClusterList& pruned) {
  const int rows = atoms == kClusterAtoms ? 1 : 2;
  const unsigned first_row = (1u << (4 * atoms)) - 1;
  pruned.rows.clear();
  pruned.masked.clear();
  pruned.clusters.resize(rows * list.clusters.size());  // room
  InRange in_range(x.x.data(), x.safely(range));
  int* next = pruned.clusters.data();
  for (const PairRow& whole : list.rows) {
    in_range.take(whole.first / kClusterAtoms, whole.shift);
    int* const begin[] = {next, next + (whole.end - whole.begin)};
    int* end[] = {begin[0], begin[1]};
    for (int k = whole.begin; k < whole.end; ++k) {
      const unsigned bits = in_range.with(list.clusters[k]);
      *end[0] = list.clusters[k];
      end[0] += (bits & first_row) != 0;
      if (rows == 1) continue;
      *end[1] = list.clusters[k];
      end[1] += (bits & ~first_row) != 0;
    }
    for (int r = 0; r < rows; ++r) {
      PairRow row{};
      row.first = whole.first + r * atoms;
      row.shift = whole.shift;
      for (int i = 0; i < atoms; ++i) row.kind |= kind[row.first + i];
      row.begin = static_cast<int>(begin[r] - pruned.clusters.data());
      row.end = static_cast<int>(end[r] - pruned.clusters.data());
      add_masks(list, whole, r * atoms, atoms, row, pruned);
      if (row.end > row.begin || row.masked_end > row.masked_begin) pruned.rows.push_back(row);
    }
    next = end[rows - 1];
  }
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(prune_rows);
void prune_list(const RoundedPositions& x, const std::vector<std::uint8_t>& kind, const ClusterList& list,
                double range, int row_atoms, ClusterList& pruned) {
  HWY_DYNAMIC_DISPATCH(prune_rows)(x, kind, list, range, row_atoms, pruned);
}

}  // namespace taut
#endif
