#include "forcefield/clusters/pair_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/clusters/prune_list.cpp"
#include "forcefield/clusters/simd_targets.hpp"
// after the targets: once a target
#include "forcefield/clusters/pair_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

// The clusters of a list with a pair of atoms within range: the same rows, shorter.
template <class T>
void prune_rows(const PairAtoms<T>& atoms, const ClusterList& list, double range, ClusterList& pruned) {
  using S = Shape<T>;
  const typename S::D d;
  const typename S::DX dx;
  constexpr double kMargin = sizeof(T) == 4 ? 1e-5 : 1e-12;  // for rounding
  const double reach = range * (1 + kMargin) / atoms.unit;
  const auto reach2 = hn::Set(d, static_cast<T>(reach * reach));
  pruned.rows.clear();
  pruned.clusters.resize(list.clusters.size());
  pruned.masked = list.masked;
  int* next = pruned.clusters.data();
  const auto number = [&](typename S::VX v) HWY_ATTR {
    if constexpr (sizeof(T) == 4)
      return hn::ConvertTo(d, v);
    else
      return v;
  };
  for (PairRow row : list.rows) {
    typename S::VX own[3][S::kVectors];
    load_row<T>(atoms.x.data(), atoms.unit, row, own);
    const int begin = static_cast<int>(next - pruned.clusters.data());
    for (int k = row.begin; k < row.end; ++k) {
      bool near = false;
      for (int part = 0; part < S::kParts; ++part) {
        const auto* x = atoms.x.data() + 12 * list.clusters[k] + part * S::kColumns;
        const auto xj = load_columns(dx, x), yj = load_columns(dx, x + 4), zj = load_columns(dx, x + 8);
        for (int v = 0; v < S::kVectors; ++v) {
          const auto ux = number(hn::Sub(own[0][v], xj)), uy = number(hn::Sub(own[1][v], yj)),
                     uz = number(hn::Sub(own[2][v], zj));
          const auto r2 = hn::MulAdd(ux, ux, hn::MulAdd(uy, uy, hn::Mul(uz, uz)));
          near |= !hn::AllFalse(d, hn::Le(r2, reach2));
        }
      }
      *next = list.clusters[k];
      next += near;
    }
    row.begin = begin;
    row.end = static_cast<int>(next - pruned.clusters.data());
    if (row.end > row.begin || row.masked_end > row.masked_begin) pruned.rows.push_back(row);
  }
}

void prune_double(const PairAtoms<double>& atoms, const ClusterList& list, double range,
                  ClusterList& pruned) {
  prune_rows(atoms, list, range, pruned);
}
void prune_float(const PairAtoms<float>& atoms, const ClusterList& list, double range, ClusterList& pruned) {
  prune_rows(atoms, list, range, pruned);
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(prune_double);
HWY_EXPORT(prune_float);

template <>
void prune_list(const PairAtoms<double>& atoms, const ClusterList& list, double range, ClusterList& pruned) {
  HWY_DYNAMIC_DISPATCH(prune_double)(atoms, list, range, pruned);
}
template <>
void prune_list(const PairAtoms<float>& atoms, const ClusterList& list, double range, ClusterList& pruned) {
  HWY_DYNAMIC_DISPATCH(prune_float)(atoms, list, range, pruned);
}

}  // namespace taut
#endif
