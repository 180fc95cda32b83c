// Which pairs of two clusters are within range. Included once a target.
#if defined(TAUT_IN_RANGE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_IN_RANGE_INL
#undef TAUT_IN_RANGE_INL
#else
#define TAUT_IN_RANGE_INL
#endif

#include "forcefield/clusters/pair_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

// A cluster, moved, against others: in AVX-512 all 4 × 4 pairs at once.
class InRange {
  using S = Shape<float>;

 public:
  // x: RoundedPositions of all clusters; reach: a range made safe for them [nm].
  HWY_INLINE InRange(const float* x, double reach)
      : x_(x), reach2_(hn::Set(S::D(), static_cast<float>(reach * reach))) {}

  HWY_INLINE void take(int cluster, const Vec3& shift) {
    const S::D d;
    for (int k = 0; k < 3; ++k)
      for (int v = 0; v < S::kVectors; ++v)
        own_[k][v] = hn::Add(load_rows(d, x_ + 12 * cluster + 4 * k + v * S::kRows),
                             hn::Set(d, static_cast<float>(shift[k])));
  }

  // Bit 4i + j: its atom i and the other cluster's j.
  HWY_INLINE unsigned with(int other) const {
    const S::D d;
    unsigned bits = 0;
    for (int part = 0; part < S::kParts; ++part) {
      const float* x = x_ + 12 * std::ptrdiff_t{other} + part * S::kColumns;
      const auto xj = load_columns(d, x), yj = load_columns(d, x + 4), zj = load_columns(d, x + 8);
      for (int v = 0; v < S::kVectors; ++v) {
        const auto dx = hn::Sub(own_[0][v], xj), dy = hn::Sub(own_[1][v], yj), dz = hn::Sub(own_[2][v], zj);
        const auto r2 = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)));
        std::uint64_t found = 0;
        hn::StoreMaskBits(d, hn::Le(r2, reach2_), reinterpret_cast<std::uint8_t*>(&found));
        bits |= static_cast<unsigned>(found) << (4 * v * S::kRows + part * S::kColumns);
      }
    }
    return bits;
  }

 private:
  const float* x_;
  S::V reach2_;
  S::V own_[3][S::kVectors];
};

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
