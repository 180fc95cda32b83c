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

// Stores those of the vector whose bits are set; up to a vector's width is written. Says where they end.
template <class D, class V = hn::Vec<D>>
HWY_INLINE int* store_those(D d, V indices, unsigned bits, int* out) {
  std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8)};
  hn::StoreU(hn::Compress(indices, hn::LoadMaskBits(d, bytes)), d, out);
  return out + hwy::PopCount(bits);
}

// A cluster, moved, against others: in AVX-512 all 4 × 4 pairs at once.
class InRange {
  using S = Shape<float>;

 public:
  // x: RoundedPositions of all clusters; reach: a range made safe for them, without margins [nm].
  HWY_INLINE InRange(const float* x, double reach)
      : x_(x), reach_(hn::Set(S::D(), static_cast<float>(reach))) {}

  HWY_INLINE void take(int cluster, const Vec3& shift) {
    const S::D d;
    for (int v = 0; v < S::kVectors; ++v) {
      const float* x = x_ + 16 * std::ptrdiff_t{cluster} + v * S::kRows;
      for (int k = 0; k < 3; ++k)
        own_[k][v] = hn::Add(load_rows(d, x + 4 * k), hn::Set(d, static_cast<float>(shift[k])));
      own_reach_[v] = hn::Add(load_rows(d, x + 12), reach_);
    }
  }

  // Bit 4i + j: its atom i and the other cluster's j.
  HWY_INLINE unsigned with(int other) const {
    const S::D d;
    unsigned bits = 0;
    for (int part = 0; part < S::kParts; ++part) {
      const float* x = x_ + 16 * std::ptrdiff_t{other} + part * S::kColumns;
      const auto xj = load_columns(d, x), yj = load_columns(d, x + 4), zj = load_columns(d, x + 8);
      const auto margin = load_columns(d, x + 12);
      for (int v = 0; v < S::kVectors; ++v) {
        const auto dx = hn::Sub(own_[0][v], xj), dy = hn::Sub(own_[1][v], yj), dz = hn::Sub(own_[2][v], zj);
        const auto r2 = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)));
        const auto reach = hn::Add(own_reach_[v], margin);
        std::uint64_t found = 0;
        hn::StoreMaskBits(d, hn::Le(r2, hn::Mul(reach, reach)), reinterpret_cast<std::uint8_t*>(&found));
        bits |= static_cast<unsigned>(found) << (4 * v * S::kRows + part * S::kColumns);
      }
    }
    return bits;
  }

  // Stores those of the clusters that hold a pair in range, of the whole cluster or of each half of it; end[]
  // is where, and where they end.
  template <int kPieces>
  HWY_INLINE void choose(const int* clusters, int count, int* (&end)[kPieces]) const {
    const hn::CappedTag<std::int32_t, 16> d;
    constexpr int kBlock = static_cast<int>(hn::MaxLanes(d));
    constexpr unsigned kPiece = (1u << 16 / kPieces) - 1;
    int k = 0;
    for (; k + kBlock <= count; k += kBlock) {
      unsigned near[kPieces] = {};
      for (int l = 0; l < kBlock; ++l) {
        const unsigned bits = with(clusters[k + l]);
        for (int p = 0; p < kPieces; ++p)
          near[p] |= unsigned{(bits & (kPiece << p * 16 / kPieces)) != 0} << l;
      }
      for (int p = 0; p < kPieces; ++p) end[p] = store_those(d, hn::LoadU(d, clusters + k), near[p], end[p]);
    }
    for (; k < count; ++k) {
      const unsigned bits = with(clusters[k]);
      for (int p = 0; p < kPieces; ++p) {
        *end[p] = clusters[k];
        end[p] += (bits & (kPiece << p * 16 / kPieces)) != 0;
      }
    }
  }

 private:
  const float* x_;
  S::V reach_;
  S::V own_[3][S::kVectors], own_reach_[S::kVectors];
};

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
