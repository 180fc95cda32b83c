// Forces of expensive pair potentials, computed only for pairs within the cutoff. Included once a target.
#if defined(TAUT_DENSE_ROWS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_DENSE_ROWS_INL
#undef TAUT_DENSE_ROWS_INL
#else
#define TAUT_DENSE_ROWS_INL
#endif

#include <algorithm>
#include <bit>

#include "forcefield/pairs/pair_law-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Half to four fifths of the pairs of listed clusters are beyond the cutoff. Here the squared distances of
// the pairs within it are packed, the potential is computed for them alone, and its values are unpacked
// again, to be multiplied by charges and depths. Distances are computed twice for that. It pays where one
// instruction packs a vector and the potential is expensive: a switch, or Ewald's screening with many terms.
template <class T, Choice choice>
constexpr bool kPacksPairs = HWY_TARGET <= HWY_AVX3&& Shape<T>::kLanes * sizeof(T) == 64 &&
                             !choice.sums() && choice.one_sigma() && (choice.switched || choice.fine);

#if HWY_TARGET <= HWY_AVX3
HWY_INLINE hn::Mask512<float> not_beyond(hn::Vec512<float> r2, hn::Vec512<float> cutoff2) {  // NaN must show
  return {_mm512_cmp_ps_mask(r2.raw, cutoff2.raw, _CMP_NGT_UQ)};
}
HWY_INLINE hn::Mask512<double> not_beyond(hn::Vec512<double> r2, hn::Vec512<double> cutoff2) {
  return {_mm512_cmp_pd_mask(r2.raw, cutoff2.raw, _CMP_NGT_UQ)};
}

// pack() moves the lanes of the mask to the front; unpack() moves them back, with zeros elsewhere.
HWY_INLINE hn::Vec512<float> pack(hn::Vec512<float> v, hn::Mask512<float> at) {
  return {_mm512_maskz_compress_ps(at.raw, v.raw)};
}
HWY_INLINE hn::Vec512<double> pack(hn::Vec512<double> v, hn::Mask512<double> at) {
  return {_mm512_maskz_compress_pd(at.raw, v.raw)};
}
HWY_INLINE hn::Vec512<float> unpack(hn::Vec512<float> v, hn::Mask512<float> at) {
  return {_mm512_maskz_expand_ps(at.raw, v.raw)};
}
HWY_INLINE hn::Vec512<double> unpack(hn::Vec512<double> v, hn::Mask512<double> at) {
  return {_mm512_maskz_expand_pd(at.raw, v.raw)};
}
#endif

template <class T, Choice choice>
class RowSum;

// Takes as many rows at a time as fit the first-level cache. Loops keep what they change in local variables,
// because the compiler cannot rule out that a store changes a member.
template <class T, Choice choice>
class PackedPairs {
  using S = Shape<T>;
  using D = typename S::D;
  using V = typename S::V;
  using VX = typename S::VX;
  using M = hn::Mask<D>;
  using Bits = decltype(M::raw);

 public:
  HWY_INLINE PackedPairs(const PairLaw& law, double unit, RowSum<T, choice>& row)
      : row_(row),
        unit2_(hn::Set(D(), static_cast<T>(unit * unit))),
        cutoff2_(hn::Set(D(), static_cast<T>(law.cutoff * law.cutoff / (unit * unit)))) {}

  HWY_INLINE void add(const PairRow& row, const ClusterList& list) {
    const int clusters = row.masked_end - row.masked_begin + row.end - row.begin;
    for (int taken = 0; taken < clusters;) {
      int end = clusters;
      // A branch, so that no loop's length waits for what was counted before.
      if (room() < clusters - taken) [[unlikely]] {
        if (room() < kFew) add_forces();
        end = std::min(clusters, taken + room());
      }
      taken = take(row, list, taken, end);
    }
  }

  // The forces of all that was taken.
  HWY_NOINLINE void add_forces() {
    apply_law();
    const D d;
    const auto* x = row_.x_of_;
    const auto& law = row_.law_;
    T* forces = row_.f_;
    const double inv_unit = row_.inv_unit_;
    int pair = 0, tile = 0;
    for (int p = 0; p < packed_rows_; ++p) {
      const PairRow& row = *packed_[p].row;
      VX own[3];
      load_row<T>(x, inv_unit, row, own);
      typename LawInLanes<T, choice>::Atoms atoms;
      law.load(row.first, atoms);
      V own_f[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
      for (const int end = packed_[p].end; tile < end; ++tile) {
        const std::ptrdiff_t cluster = cluster_[tile];
        const M within{within_[tile]};
        V r[3], coulomb{}, lj{}, f[3];
        subtract(own, x, cluster, r);
        if constexpr (choice.charge) coulomb = unpack(hn::LoadU(d, r2_ + pair), within);
        if constexpr (choice.lj) lj = unpack(hn::LoadU(d, lj_ + pair), within);
        const V term = law.term(atoms, 4 * cluster, coulomb, lj);
        for (int k = 0; k < 3; ++k) own_f[k] += term * r[k];
        // stores together: among the loads they cost 3 cycles more
        T* of = forces + 3 * cluster * S::kLanes;
        for (int k = 0; k < 3; ++k) f[k] = hn::Load(d, of + k * S::kLanes) - term * r[k];
        for (int k = 0; k < 3; ++k) hn::Store(f[k], d, of + k * S::kLanes);
        pair += std::popcount(unsigned{within_[tile]});
      }
      for (int k = 0; k < 3; ++k) row_.own_f_[k] = own_f[k];
      row_.store(row);
    }
    packed_rows_ = tiles_ = pairs_ = 0;
  }

 private:
  // Of how many more clusters there is room.
  int room() const { return std::min((kPairs - pairs_) / S::kLanes, kTiles - tiles_); }

  // Packs the squared distances of a row with its clusters from .. end, the masked ones first. Returns `end`.
  HWY_INLINE int take(const PairRow& row, const ClusterList& list, int from, int end) {
    const D d;
    const V cutoff2 = cutoff2_;
    const auto* x = row_.x_of_;
    VX own[3];
    load_row<T>(x, row_.inv_unit_, row, own);
    int pairs = pairs_, tiles = tiles_;
    const auto add = [&](int cluster, unsigned counted) HWY_ATTR {
      V r[3];
      subtract(own, x, cluster, r);
      const V r2 = square(r);
      const M within{static_cast<Bits>(not_beyond(r2, cutoff2).raw & counted)};
      const unsigned bits = within.raw;
      hn::StoreU(pack(r2, within), d, r2_ + pairs);
      cluster_[tiles] = cluster;
      within_[tiles] = static_cast<Bits>(bits);
      pairs += std::popcount(bits);
      tiles += bits != 0;
    };
    const int masked = row.masked_end - row.masked_begin;
    int k = from;
    for (const MaskedCluster* of = list.masked.data() + row.masked_begin; k < std::min(end, masked); ++k)
      add(of[k].cluster, of[k].mask);
    for (const int* of = list.clusters.data() + row.begin - masked; k < end; ++k) add(of[k], ~0u);
    if (tiles > tiles_) packed_[packed_rows_++] = {&row, tiles};
    pairs_ = pairs;
    tiles_ = tiles;
    return end;
  }

  static HWY_INLINE void subtract(const VX (&own)[3], const auto* x, std::ptrdiff_t cluster, V (&r)[3]) {
    const typename S::DX d;
    for (int k = 0; k < 3; ++k)
      r[k] = RowSum<T, choice>::as_real(own[k] - load_columns(d, x + entry(4 * cluster, k)));
  }

  // Coulomb's part takes the place of the squared distances.
  HWY_NOINLINE void apply_law() {
    const D d;
    constexpr int K = kAtOnce;
    for (int p = 0; p < pairs_; p += K * S::kLanes) {
      V r2[K], coulomb[K], lj[K];
      for (int k = 0; k < K; ++k) {
        r2[k] = hn::Load(d, r2_ + p + k * S::kLanes);
        if constexpr (sizeof(T) == 4) r2[k] *= unit2_;
      }
      row_.law_.template of_distances<K>(r2, coulomb, lj);
      for (int k = 0; k < K; ++k) {
        if constexpr (choice.charge) hn::Store(coulomb[k], d, r2_ + p + k * S::kLanes);
        if constexpr (choice.lj) hn::Store(lj[k], d, lj_ + p + k * S::kLanes);
      }
    }
  }

  static constexpr int kAtOnce = 3;  // vectors: none waits for another, and all stay in registers
  static constexpr int kPairs = 8192 / sizeof(T), kTiles = kPairs / 2;
  static constexpr int kFew = 8;                                 // clusters, not worth loading a row
  static constexpr int kNumbers = kPairs + kAtOnce * S::kLanes;  // up to the last vector's end
  struct PackedRow {
    const PairRow* row;
    int end;  // of its tiles
  };

  RowSum<T, choice>& row_;
  V unit2_, cutoff2_;  // unit², and the cutoff's square in it
  int packed_rows_ = 0, tiles_ = 0, pairs_ = 0;
  PackedRow packed_[kTiles];
  int cluster_[kTiles + 1];  // of tiles that hold pairs
  Bits within_[kTiles + 1];
  alignas(64) T r2_[kNumbers];
  alignas(64) T lj_[choice.lj ? kNumbers : 1];
};

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
