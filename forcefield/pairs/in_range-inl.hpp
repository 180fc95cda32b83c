// Which pairs of two clusters are within range. Included once a target.
#if defined(TAUT_IN_RANGE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_IN_RANGE_INL
#undef TAUT_IN_RANGE_INL
#else
#define TAUT_IN_RANGE_INL
#endif

#include "forcefield/pairs/pair_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

// Stores the lanes whose bits are set, packed; a whole vector may be written. Returns their end.
template <class D, class V = hn::Vec<D>>
HWY_INLINE int* store_those(D d, V indices, unsigned bits, int* out) {
  std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8)};
  hn::StoreU(hn::Compress(indices, hn::LoadMaskBits(d, bytes)), d, out);
  return out + hwy::PopCount(bits);
}

// Tests which pairs of an i-cluster, shifted, and another cluster are within range: in AVX-512 all 4 × 4 at
// once.
class InRange {
  using S = Shape<float>;
  static constexpr int kVectors = kClusterAtoms / S::kRows;  // of a cluster

 public:
  // x: RoundedPositions of all clusters; range: a range made safe for them, without margins [nm].
  HWY_INLINE InRange(const float* x, double range)
      : x_(x), range_(hn::Set(S::D(), static_cast<float>(range))) {}

  HWY_INLINE void take(int cluster, const Vec3& shift) {
    const S::D d;
    for (int v = 0; v < kVectors; ++v) {
      const float* x = x_ + entry(4 * std::ptrdiff_t{cluster}, 0, 4) + v * S::kRows;
      for (int k = 0; k < 3; ++k) own_[k][v] = load_rows(d, x + 4 * k) + static_cast<float>(shift[k]);
      own_range_[v] = load_rows(d, x + 12) + range_;
    }
  }

  // Bit 4i + j is set where atom i of the i-cluster and atom j of the other are within range.
  HWY_INLINE unsigned with(int other) const {
    const S::D d;
    unsigned bits = 0;
    for (int part = 0; part < S::kParts; ++part) {
      const float* x = x_ + entry(4 * std::ptrdiff_t{other}, 0, 4) + part * S::kColumns;
      const auto xj = load_columns(d, x), yj = load_columns(d, x + 4), zj = load_columns(d, x + 8);
      const auto margin = load_columns(d, x + 12);
      for (int v = 0; v < kVectors; ++v) {
        const S::V r[3] = {own_[0][v] - xj, own_[1][v] - yj, own_[2][v] - zj};
        const auto range = own_range_[v] + margin;
        std::uint64_t found = 0;
        hn::StoreMaskBits(d, square(r) <= range * range, reinterpret_cast<std::uint8_t*>(&found));
        bits |= static_cast<unsigned>(found) << (4 * v * S::kRows + part * S::kColumns);
      }
    }
    return bits;
  }

  // Stores the clusters that hold a pair in range of the i-cluster (kParts = 1), of each half (2) or atom (4) of it
  // from end[] on, and moves end[] behind them.
  template <int kParts>
  HWY_INLINE void choose(const int* clusters, int count, int* (&end)[kParts]) const {
    const hn::CappedTag<std::int32_t, 16> d;
    constexpr int kBlock = static_cast<int>(hn::MaxLanes(d));
    constexpr unsigned kPart = (1u << 16 / kParts) - 1;
    int k = 0;
    for (; k + kBlock <= count; k += kBlock) {
      unsigned near[kParts] = {};
      for (int l = 0; l < kBlock; ++l) {
        const unsigned bits = with(clusters[k + l]);
        for (int p = 0; p < kParts; ++p) near[p] |= unsigned{(bits & (kPart << p * 16 / kParts)) != 0} << l;
      }
      for (int p = 0; p < kParts; ++p) end[p] = store_those(d, hn::LoadU(d, clusters + k), near[p], end[p]);
    }
    for (; k < count; ++k) {
      const unsigned bits = with(clusters[k]);
      for (int p = 0; p < kParts; ++p) {
        *end[p] = clusters[k];
        end[p] += (bits & (kPart << p * 16 / kParts)) != 0;
      }
    }
  }

 private:
  const float* x_;
  S::V range_;
  S::V own_[3][kVectors], own_range_[kVectors];
};

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
