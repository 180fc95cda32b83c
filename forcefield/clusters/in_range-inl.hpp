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
  HWY_INLINE InRange(const FixedPositions& x, double range) : x_(x) {
    const double reach = x.safely(range) / x.unit;
    reach2_ = hn::Set(S::D(), static_cast<float>(reach * reach));
  }

  HWY_INLINE void take(int cluster, const Vec3& shift) {
    PairRow row{};
    row.first = kClusterAtoms * cluster;
    row.shift = shift;
    load_row<float>(x_.x.data(), x_.unit, row, own_);
  }

  // Bit 4i + j: its atom i and the other cluster's j.
  HWY_INLINE unsigned with(int other) const {
    const S::D d;
    const S::DX dx;
    unsigned bits = 0;
    for (int part = 0; part < S::kParts; ++part) {
      const auto* x = x_.x.data() + 12 * other + part * S::kColumns;
      const auto xj = load_columns(dx, x), yj = load_columns(dx, x + 4), zj = load_columns(dx, x + 8);
      for (int v = 0; v < S::kVectors; ++v) {
        const auto ux = hn::ConvertTo(d, hn::Sub(own_[0][v], xj)),
                   uy = hn::ConvertTo(d, hn::Sub(own_[1][v], yj)),
                   uz = hn::ConvertTo(d, hn::Sub(own_[2][v], zj));
        const auto r2 = hn::MulAdd(ux, ux, hn::MulAdd(uy, uy, hn::Mul(uz, uz)));
        std::uint8_t bytes[8] = {};
        hn::StoreMaskBits(d, hn::Le(r2, reach2_), bytes);
        bits |= unsigned(bytes[0] | bytes[1] << 8) << (4 * v * S::kRows + part * S::kColumns);
      }
    }
    return bits;
  }

 private:
  const FixedPositions& x_;
  S::V reach2_;
  S::VX own_[3][S::kVectors];
};

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
