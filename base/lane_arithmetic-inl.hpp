// Vectors of lanes and numbers in one formula: 2 * x + y. A number counts in every lane. Included once a target.
// Compilers fuse a product and the sum it goes into (CMakeLists.txt sees to it). Of two products g++ fuses the one it
// computes first: in a * b + c * d the second, but the first if it stands in a line above. hn::MulAdd and hn::MulSub say
// which where it would be the wrong one.
#if defined(TAUT_LANE_ARITHMETIC_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_LANE_ARITHMETIC_INL
#undef TAUT_LANE_ARITHMETIC_INL
#else
#define TAUT_LANE_ARITHMETIC_INL
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#define TAUT_WITH_NUMBERS(op)                         \
  template <class V>                                  \
  HWY_INLINE auto operator op(V a, hn::TFromV<V> b) { \
    return a op hn::Set(hn::DFromV<V>(), b);          \
  }                                                   \
  template <class V>                                  \
  HWY_INLINE auto operator op(hn::TFromV<V> a, V b) { \
    return hn::Set(hn::DFromV<V>(), a) op b;          \
  }
TAUT_WITH_NUMBERS(+)
TAUT_WITH_NUMBERS(-)
TAUT_WITH_NUMBERS(*)
TAUT_WITH_NUMBERS(/)
TAUT_WITH_NUMBERS(<)
TAUT_WITH_NUMBERS(<=)
TAUT_WITH_NUMBERS(>)
TAUT_WITH_NUMBERS(>=)
TAUT_WITH_NUMBERS(==)
#undef TAUT_WITH_NUMBERS

template <class V, class T = hn::TFromV<V>>
HWY_INLINE V operator-(V a) {
  return hn::Neg(a);
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
