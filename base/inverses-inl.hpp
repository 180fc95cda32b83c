// Inverses of squared distances. Included once a target.
#if defined(TAUT_INVERSES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_INVERSES_INL
#undef TAUT_INVERSES_INL
#else
#define TAUT_INVERSES_INL
#endif

#include "base/lane_arithmetic-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// True on targets whose instruction for an approximate 1/√x is used: it has 14 bits in AVX-512, and 12 bits
// for floats in SSE and AVX2. Other targets have a coarser one, or none.
template <class D>
constexpr bool kRootGuessed = sizeof(hn::TFromD<D>) == 4 ? HWY_TARGET <= HWY_SSSE3
                                                         : HWY_TARGET <= HWY_AVX3&& hn::MaxLanes(D()) == 8;

// The approximation where it is used, else 1/√x.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V guess_inverse_sqrt(D, V x) {
  using T = hn::TFromD<D>;
#if HWY_TARGET <= HWY_AVX3
  if constexpr (sizeof(T) == 8 && kRootGuessed<D>) return V{_mm512_rsqrt14_pd(x.raw)};
#endif
  if constexpr (sizeof(T) == 4 && kRootGuessed<D>)
    return hn::ApproximateReciprocalSqrt(x);
  else
    return 1 / hn::Sqrt(x);
}

// The same for 1/x: 14 bits for doubles in AVX-512.
template <class D>
constexpr bool kInverseGuessed = sizeof(hn::TFromD<D>) == 8 && kRootGuessed<D>;

template <class D, class V = hn::Vec<D>>
HWY_INLINE V guess_inverse(D, V x) {
#if HWY_TARGET <= HWY_AVX3
  if constexpr (kInverseGuessed<D>) return V{_mm512_rcp14_pd(x.raw)};
#endif
  return 1 / x;
}

// The functions below refine guesses y of K vectors. Each stage handles all K vectors before the next stage
// begins, so that the latency of one is hidden behind the others.

// 1/√x = y(1 + e/2 + 3e²/8 + 5e³/16 + …), e = 1 − xy². In float 3e²/8 is left out.
template <int K, class D, class V = hn::Vec<D>>
HWY_INLINE void inverse_sqrt(D d, const V (&x)[K], V (&y)[K]) {
  if constexpr (kRootGuessed<D>) {
    using T = hn::TFromD<D>;
    V e[K];
    for (int k = 0; k < K; ++k) e[k] = 1 - x[k] * y[k] * y[k];
    for (int k = 0; k < K; ++k) {
      V p = hn::Set(d, T(0.5));
      if constexpr (sizeof(T) == 8) p += (0.3125 * e[k] + 0.375) * e[k];
      y[k] += y[k] * e[k] * p;
    }
  }
}

// kCubeScale/√x³ by 1/√x³ = y³(1 + 3e/2 + 15e²/8 + 35e³/16 + …), e = 1 − xy²: faster than by 1/√x. The caller
// multiplies the constants of its forces by 1/kCubeScale, which saves the last product of the series. In
// float 35e³/16 is left out and, where the guess has 14 bits, 15e²/8.
template <class D>
constexpr bool kFineFloat = sizeof(hn::TFromD<D>) == 4 && HWY_TARGET <= HWY_AVX3&& hn::MaxLanes(D()) == 16;
template <class D>
constexpr double kCubeScale = kFineFloat<D>        ? double(5.0f / 3) - 1
                              : kInverseGuessed<D> ? 16.0 / 35
                                                   : 1.0;

template <int K, class D, class V = hn::Vec<D>>
HWY_INLINE void inverse_cube(D, const V (&x)[K], V (&y)[K]) {
  using T = hn::TFromD<D>;
  V y2[K], y3[K];
  for (int k = 0; k < K; ++k) y2[k] = y[k] * y[k];
  for (int k = 0; k < K; ++k) y3[k] = y2[k] * y[k];
  for (int k = 0; k < K; ++k) {
    if constexpr (kFineFloat<D>) {
      y[k] = y3[k] * (T(5.0f / 3) - x[k] * y2[k]);
    } else if constexpr (kRootGuessed<D>) {
      const V e = 1 - x[k] * y2[k];
      if constexpr (sizeof(T) == 8) {
        const V p = (T(6.0 / 7) + e) * e + T(24.0 / 35);
        y[k] = y3[k] * (p * e + T(16.0 / 35));
      } else {
        y[k] = y3[k] + y3[k] * e * (1.5 + 1.875 * e);
      }
    } else {
      y[k] = y3[k];
    }
  }
}

// 1/x = y(1 + e + e² + e³ + …), e = 1 − xy.
template <int K, class D, class V = hn::Vec<D>>
HWY_INLINE void inverse(D, const V (&x)[K], V (&y)[K]) {
  if constexpr (kInverseGuessed<D>) {
    V e[K];
    for (int k = 0; k < K; ++k) e[k] = 1 - x[k] * y[k];
    for (int k = 0; k < K; ++k) y[k] += y[k] * e[k] * (1 + e[k] * (1 + e[k]));
  }
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
