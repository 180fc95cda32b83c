// The layout of pairs of atoms in vectors. Included once a target.
#if defined(TAUT_PAIR_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_PAIR_LANES_INL
#undef TAUT_PAIR_LANES_INL
#else
#define TAUT_PAIR_LANES_INL
#endif

#include <algorithm>

#include "base/lane_arithmetic-inl.hpp"
#include "forcefield/pairs/pair_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A vector holds the kRows atoms of a row by kColumns of a cluster: 2 × 4 doubles or 4 × 4 floats in AVX-512,
// 1 × 4 doubles or 2 × 4 floats in AVX2, 1 × 2 doubles or 1 × 4 floats in NEON. The fewer atoms a row has, the fewer of
// the pairs with its clusters are beyond the cutoff, and the more of what it needs stays in registers.
template <class T>
struct Shape {
  using D = hn::CappedTag<T, 64 / sizeof(T)>;
  using V = hn::Vec<D>;
  using Coordinate = typename PairPrecision<T>::Coordinate;
  using DX = hn::Rebind<Coordinate, D>;
  using VX = hn::Vec<DX>;
  static constexpr int kLanes = static_cast<int>(hn::MaxLanes(D()));
  static constexpr int kColumns = std::min(kLanes, 4), kRows = kLanes / kColumns;
  static constexpr int kParts = 4 / kColumns;  // of a cluster
};

// Loads four numbers of a cluster (or as many as fit), repeated for each of the vector's rows.
template <class DT>
HWY_INLINE hn::Vec<DT> load_columns(DT d, const hn::TFromD<DT>* p) {
  constexpr int lanes = static_cast<int>(hn::MaxLanes(DT()));
  if constexpr (lanes <= 4) return hn::Load(d, p);
#if HWY_TARGET <= HWY_AVX3
  if constexpr (lanes == 8 && sizeof(*p) == 8) return hn::Vec<DT>{_mm512_broadcast_f64x4(_mm256_load_pd(p))};
#endif
#if HWY_TARGET != HWY_SCALAR
  if constexpr (lanes > 4 && sizeof(*p) == 4) return hn::LoadDup128(d, p);
#endif
}

// Loads kRows consecutive numbers, each repeated across the columns.
template <class DT>
HWY_INLINE hn::Vec<DT> load_rows(DT d, const hn::TFromD<DT>* p) {
#if HWY_TARGET <= HWY_AVX3
  if constexpr (hn::MaxLanes(DT()) == 16) {
    const auto row =
        _mm512_srli_epi32(_mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0), 2);
    const __m128i four = _mm_load_si128(reinterpret_cast<const __m128i*>(p));
    return hn::BitCast(d,
                       hn::Vec512<std::int32_t>{_mm512_permutexvar_epi32(row, _mm512_castsi128_si512(four))});
  }
#endif
  constexpr int lanes = static_cast<int>(hn::MaxLanes(DT())), columns = std::min(lanes, 4);
  constexpr int rows = lanes / columns;
  auto v = hn::Set(d, p[rows - 1]);
  for (int i = rows - 2; i >= 0; --i)
    v = hn::IfThenElse(hn::FirstN(d, (i + 1) * columns), hn::Set(d, p[i]), v);
  return v;
}

// The positions of a row's atoms, moved by its shift [unit].
template <class T, class S = Shape<T>>
HWY_INLINE void load_row(const typename S::Coordinate* x, double inv_unit, const PairRow& row,
                         typename S::VX (&out)[3]) {
  const typename S::DX d;
  x += entry(row.first, 0);
  for (int k = 0; k < 3; ++k) {
    const auto shift = PairPrecision<T>::coordinate(row.shift[k] * inv_unit);
    out[k] = load_rows(d, x + 4 * k) + shift;
  }
}

// |r|²
template <class V>
HWY_INLINE V square(const V (&r)[3]) {
  return r[2] * r[2] + r[1] * r[1] + r[0] * r[0];
}

// In every lane, the sum over its row.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V sum_columns([[maybe_unused]] D d, V v) {
  constexpr int lanes = static_cast<int>(hn::MaxLanes(D()));
  if constexpr (lanes == 1) return v;
#if HWY_TARGET != HWY_SCALAR
  if constexpr (sizeof(hn::TFromD<D>) == 4) {
    v += hn::Shuffle2301(v);
    v += hn::Shuffle1032(v);
  } else {
    v += hn::Shuffle01(v);
    if constexpr (lanes >= 4) v += hn::SwapAdjacentBlocks(v);
  }
#endif
  return v;
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
