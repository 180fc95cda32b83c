// Inverses of squared distances. Included once a target.
#if defined(TAUT_INVERSES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_INVERSES_INL
#undef TAUT_INVERSES_INL
#else
#define TAUT_INVERSES_INL
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// y = 1/√x of K vectors, stage by stage, so that none waits for another's.
template <int K, class D, class V = hn::Vec<D>>
HWY_INLINE void inverse_sqrt(D d, const V (&x)[K], V (&y)[K]) {
  using T = hn::TFromD<D>;
  const V one = hn::Set(d, T(1)), half = hn::Set(d, T(0.5));
  V e[K];
#if HWY_TARGET <= HWY_AVX3
  // From 14 bits, y ← y(1 + e/2 + 3e²/8 + 5e³/16), e = 1 − xy², leaves e⁴.
  if constexpr (sizeof(T) == 8 && hn::MaxLanes(D()) == 8) {
    for (int k = 0; k < K; ++k) y[k] = V{_mm512_rsqrt14_pd(x[k].raw)};
    for (int k = 0; k < K; ++k) e[k] = hn::NegMulAdd(hn::Mul(x[k], y[k]), y[k], one);
    for (int k = 0; k < K; ++k) {
      const V p = hn::MulAdd(hn::MulAdd(hn::Set(d, T(0.3125)), e[k], hn::Set(d, T(0.375))), e[k], half);
      y[k] = hn::MulAdd(hn::Mul(y[k], e[k]), p, y[k]);
    }
    return;
  }
#endif
  for (int k = 0; k < K; ++k) {
    if constexpr (sizeof(T) == 4) {  // leaves 3e²/8
      y[k] = hn::ApproximateReciprocalSqrt(x[k]);
      e[k] = hn::NegMulAdd(hn::Mul(x[k], y[k]), y[k], one);
      y[k] = hn::MulAdd(hn::Mul(half, y[k]), e[k], y[k]);
    } else {
      y[k] = hn::Div(one, hn::Sqrt(x[k]));
    }
  }
}

// y = 1/x: from z of 14 bits, y = z(1 + e + e² + e³), e = 1 − xz.
template <int K, class D, class V = hn::Vec<D>>
HWY_INLINE void inverse(D d, const V (&x)[K], V (&y)[K]) {
  using T = hn::TFromD<D>;
  const V one = hn::Set(d, T(1));
#if HWY_TARGET <= HWY_AVX3
  if constexpr (sizeof(T) == 8 && hn::MaxLanes(D()) == 8) {
    V e[K];
    for (int k = 0; k < K; ++k) y[k] = V{_mm512_rcp14_pd(x[k].raw)};
    for (int k = 0; k < K; ++k) e[k] = hn::NegMulAdd(x[k], y[k], one);
    for (int k = 0; k < K; ++k)
      y[k] = hn::MulAdd(hn::Mul(y[k], e[k]), hn::MulAdd(e[k], hn::Add(e[k], one), one), y[k]);
    return;
  }
#endif
  for (int k = 0; k < K; ++k) y[k] = hn::Div(one, x[k]);
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
