#include "forcefield/pairs/prune_list.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/pairs/prune_list.cpp"
#include "base/simd_targets.hpp"
// after the targets: once a target
#include "forcefield/pairs/in_range-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

constexpr int kWidest = 16;

// Copies the part of a row's masks that concerns the atoms from `first` on, 4 bits an atom.
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

// Copies in whole vectors: up to a vector more is read and written. Returns the end.
HWY_INLINE int* copy_some(const int* from, int count, int* to) {
  const hn::CappedTag<std::int32_t, kWidest> d;
  for (int k = 0; k < count; k += static_cast<int>(hn::MaxLanes(d)))
    hn::StoreU(hn::LoadU(d, from + k), d, to + k);
  return to + count;
}

// Cuts rows of four atoms into kParts rows, each with the clusters that hold a pair in range of it.
template <int kParts>
HWY_INLINE void prune_in_parts(const Pruning& how, const ClusterList& list, RowRange range,
                               ClusterList& pruned) {
  constexpr int kAtoms = kClusterAtoms / kParts;
  const int used = pruned.rows.empty() ? 0 : pruned.rows.back().end;
  const int most = list.rows[range.end - 1].end - list.rows[range.begin].begin;
  pruned.clusters.resize(
      std::max(pruned.clusters.size(), std::size_t(used) + std::size_t(kParts) * most + kWidest));
  InRange in_range(how.x.x.data(), how.x.safely(how.range));
  int* next = pruned.clusters.data() + used;
  const double shells_per_nm = kShells / how.buffer;
  for (int r = range.begin; r < range.end; ++r) {
    const PairRow& whole = list.rows[r];
    // clusters further apart than both have moved stay out of range
    const double moved = how.moved[whole.first / kClusterAtoms] + how.farthest;
    const int shells = static_cast<int>(std::min(1 + shells_per_nm * moved, double{kShells}));  // moved: or ∞
    const int core = list.shells[r][0], end_of_shells = list.shells[r][shells];
    const int* clusters = list.clusters.data();
    in_range.take(whole.first / kClusterAtoms, whole.shift);
    int *begin[kParts], *end[kParts];
    for (int p = 0; p < kParts; ++p) {
      begin[p] = next + p * (end_of_shells - whole.begin);
      end[p] = copy_some(clusters + whole.begin, core - whole.begin, begin[p]);
    }
    in_range.choose(clusters + core, end_of_shells - core, end);
    for (int p = 0; p < kParts; ++p) {
      PairRow row{};
      row.first = whole.first + p * kAtoms;
      row.shift = whole.shift;
      for (int i = 0; i < kAtoms && kParts > 1; ++i) row.kind |= how.kind[row.first + i];
      if (kParts == 1 || (row.kind & kHasLj) != 0)
        row.kind |= whole.kind & (kParts == 1 ? ~0 : kHasOtherType);
      row.begin = static_cast<int>(begin[p] - pruned.clusters.data());
      row.end = static_cast<int>(end[p] - pruned.clusters.data());
      add_masks(list, whole, p * kAtoms, kAtoms, row, pruned);
      if (row.end > row.begin || row.masked_end > row.masked_begin) pruned.rows.push_back(row);
    }
    next = end[kParts - 1];
  }
}

void prune_rows(const Pruning& how, const ClusterList& list, RowRange range, ClusterList& pruned) {
  how.row_atoms == 4   ? prune_in_parts<1>(how, list, range, pruned)
  : how.row_atoms == 2 ? prune_in_parts<2>(how, list, range, pruned)
                       : prune_in_parts<4>(how, list, range, pruned);
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(prune_rows);
void Pruning::add(const ClusterList& list, RowRange rows, ClusterList& pruned) const {
  if (rows.begin < rows.end) HWY_DYNAMIC_DISPATCH(prune_rows)(*this, list, rows, pruned);
}

}  // namespace taut
#endif
