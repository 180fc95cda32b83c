// Vectors of space (x, y, z), one in each SIMD lane; compiled once for each target of Highway's
// foreach_target.
#if defined(TAUT_VECTOR_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_VECTOR_LANES_INL_H
#undef TAUT_VECTOR_LANES_INL_H
#else
#define TAUT_VECTOR_LANES_INL_H
#endif

#include "base/lane_arithmetic-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
inline constexpr int kWidth = static_cast<int>(hn::MaxLanes(D()));  // lanes worked on at once

HWY_INLINE V load(const double* row) {
  return hn::Load(D(), row);
}
HWY_INLINE void store(V value, double* row) {
  hn::Store(value, D(), row);
}
HWY_INLINE V broadcast(double value) {
  return hn::Set(D(), value);
}

struct V3 {
  V x, y, z;
};
HWY_INLINE V3 operator+(const V3& a, const V3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
HWY_INLINE V3 operator-(const V3& a, const V3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
HWY_INLINE V3 operator-(const V3& a) {
  return {-a.x, -a.y, -a.z};
}
HWY_INLINE V3 operator*(V s, const V3& a) {
  return {s * a.x, s * a.y, s * a.z};
}
HWY_INLINE V3 operator*(double s, const V3& a) {
  return broadcast(s) * a;
}
HWY_INLINE V dot(const V3& a, const V3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
HWY_INLINE V3 cross(const V3& a, const V3& b) {
  return {hn::MulSub(a.y, b.z, a.z * b.y), hn::MulSub(a.z, b.x, a.x * b.z), hn::MulSub(a.x, b.y, a.y * b.x)};
}

using Four = hn::CappedTag<double, 4>;
using FourV = hn::Vec<Four>;
#if HWY_TARGET <= HWY_AVX2
// Transposes (x, y, z, any) of four atoms to x of all four, y and z.
HWY_INLINE void by_axes(const FourV (&atom)[4], FourV (&axis)[3]) {
  const Four d;
  const auto xz01 = hn::InterleaveLower(d, atom[0], atom[1]), xz23 = hn::InterleaveLower(d, atom[2], atom[3]);
  const auto y01 = hn::InterleaveUpper(d, atom[0], atom[1]), y23 = hn::InterleaveUpper(d, atom[2], atom[3]);
  axis[0] = hn::ConcatLowerLower(d, xz23, xz01);
  axis[1] = hn::ConcatLowerLower(d, y23, y01);
  axis[2] = hn::ConcatUpperUpper(d, xz23, xz01);
}
// Transposes x of four atoms, y and z to (x, y, z, any) of each.
HWY_INLINE void by_atoms(const FourV (&axis)[3], FourV (&atom)[4]) {
  const Four d;
  const auto xy02 = hn::InterleaveLower(d, axis[0], axis[1]), xy13 = hn::InterleaveUpper(d, axis[0], axis[1]);
  const auto z02 = hn::InterleaveLower(d, axis[2], axis[2]), z13 = hn::InterleaveUpper(d, axis[2], axis[2]);
  atom[0] = hn::ConcatLowerLower(d, z02, xy02);
  atom[1] = hn::ConcatLowerLower(d, z13, xy13);
  atom[2] = hn::ConcatUpperUpper(d, z02, xy02);
  atom[3] = hn::ConcatUpperUpper(d, z13, xy13);
}
#endif

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
