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

// How many bits the guess of 1/√x has that a target is served with, 0 where none is used: 14 in AVX-512, else 12, which SSE
// and AVX2 have for floats; AVX2's doubles take the floats' guess. Other targets have a coarser one, or none.
template <class D>
constexpr int guessed_root_bits() {
  if (sizeof(hn::TFromD<D>) == 4)
    return HWY_TARGET <= HWY_AVX3 && hn::MaxLanes(D()) == 16 ? 14 : HWY_TARGET <= HWY_SSSE3 ? 12 : 0;
  return HWY_TARGET <= HWY_AVX3 && hn::MaxLanes(D()) == 8 ? 14 : HWY_TARGET == HWY_AVX2 ? 12 : 0;
}
template <class D>
constexpr int kRootBits = guessed_root_bits<D>();

// The guess where there is one, else 1/√x.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V guess_inverse_sqrt(D d, V x) {
  using T = hn::TFromD<D>;
#if HWY_TARGET <= HWY_AVX3
  if constexpr (sizeof(T) == 8 && kRootBits<D> == 14) return V{_mm512_rsqrt14_pd(x.raw)};
#endif
  if constexpr (sizeof(T) == 4 && (kRootBits<D>) > 0) return hn::ApproximateReciprocalSqrt(x);
  if constexpr (sizeof(T) == 8 && kRootBits<D> == 12) {
    const hn::Rebind<float, D> floats;
    return hn::PromoteTo(d, hn::ApproximateReciprocalSqrt(hn::DemoteTo(floats, x)));
  }
  return 1 / hn::Sqrt(x);
}

// The same for 1/x: 14 bits for doubles in AVX-512.
template <class D>
constexpr bool kInverseGuessed = sizeof(hn::TFromD<D>) == 8 && kRootBits<D> == 14;

template <class D, class V = hn::Vec<D>>
HWY_INLINE V guess_inverse(D, V x) {
#if HWY_TARGET <= HWY_AVX3
  if constexpr (kInverseGuessed<D>) return V{_mm512_rcp14_pd(x.raw)};
#endif
  return 1 / x;
}

// The functions below refine guesses y of K vectors. Each stage handles all K vectors before the next stage
// begins, so that the latency of one is hidden behind the others.

// 1/√x = y(1 + e/2 + 3e²/8 + 5e³/16 + 35e⁴/128 + …), e = 1 − xy². A guess of 12 bits has |e| < 8e-4, one of 14 bits 2e-4:
// in double all terms above 1e-15 are taken, in float 3e²/8 is left out.
template <int K, class D, class V = hn::Vec<D>>
HWY_INLINE void inverse_sqrt(D d, const V (&x)[K], V (&y)[K]) {
  if constexpr ((kRootBits<D>) > 0) {
    using T = hn::TFromD<D>;
    V e[K];
    for (int k = 0; k < K; ++k) e[k] = 1 - x[k] * y[k] * y[k];
    for (int k = 0; k < K; ++k) {
      V p = hn::Set(d, T(0.5));
      if constexpr (sizeof(T) == 8 && kRootBits<D> == 12)
        p += ((35.0 / 128 * e[k] + 0.3125) * e[k] + 0.375) * e[k];
      else if constexpr (sizeof(T) == 8)
        p += (0.3125 * e[k] + 0.375) * e[k];
      y[k] += y[k] * e[k] * p;
    }
  }
}

// kCubeScale/√x³ by 1/√x³ = y³(1 + 3e/2 + 15e²/8 + 35e³/16 + 315e⁴/128 + …), e = 1 − xy²: faster than by 1/√x. The caller
// multiplies the constants of its forces by 1/kCubeScale, which saves the last product of the series. In double the series
// ends with e⁴ for a guess of 12 bits and with e³ for one of 14; in float with e² and e.
template <class D>
constexpr bool kFineFloat = sizeof(hn::TFromD<D>) == 4 && kRootBits<D> == 14;
template <class D>
constexpr double kCubeScale = kFineFloat<D>                ? double(5.0f / 3) - 1
                              : kRootBits<D> == 0          ? 1.0
                              : sizeof(hn::TFromD<D>) == 4 ? double(8.0f / 15)
                              : kRootBits<D> == 12         ? 128.0 / 315
                                                           : 16.0 / 35;

template <int K, class D, class V = hn::Vec<D>>
HWY_INLINE void inverse_cube(D, const V (&x)[K], V (&y)[K]) {
  using T = hn::TFromD<D>;
  V y2[K], y3[K];
  for (int k = 0; k < K; ++k) y2[k] = y[k] * y[k];
  for (int k = 0; k < K; ++k) y3[k] = y2[k] * y[k];
  for (int k = 0; k < K; ++k) {
    if constexpr (kFineFloat<D>) {
      y[k] = y3[k] * (T(5.0f / 3) - x[k] * y2[k]);
    } else if constexpr (kRootBits<D> > 0) {
      const V e = 1 - x[k] * y2[k];
      if constexpr (sizeof(T) == 4)
        y[k] = y3[k] * ((e + T(0.8)) * e + T(8.0f / 15));
      else if constexpr (kRootBits<D> == 12)
        y[k] = y3[k] * ((((e + 8.0 / 9) * e + 16.0 / 21) * e + 64.0 / 105) * e + 128.0 / 315);
      else
        y[k] = y3[k] * (((T(6.0 / 7) + e) * e + T(24.0 / 35)) * e + T(16.0 / 35));
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
