#include "forcefield/pairs/cluster_scan.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/pairs/cluster_scan.cpp"
#include "base/simd_targets.hpp"
// after the targets: once a target
#include "base/lane_arithmetic-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

using D = hn::CappedTag<float, SideBySide::kSpare>;
using V = hn::Vec<D>;
using Indices = hn::Rebind<std::int32_t, D>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(D()));
constexpr float kNowhere = 1e15F;  // [nm]
constexpr unsigned kEvery = (1u << kLanes) - 1;

HWY_INLINE unsigned bits_of(hn::Mask<D> mask) {
  std::uint64_t bits = 0;
  hn::StoreMaskBits(D(), mask, reinterpret_cast<std::uint8_t*>(&bits));
  return static_cast<unsigned>(bits) & kEvery;
}

// How far [low, high] is from each of the intervals of the clusters.
HWY_INLINE V gap(V low, V high, const float* lows, const float* highs) {
  const D d;
  const V below = low - hn::LoadU(d, highs), above = hn::LoadU(d, lows) - high;
  return hn::Max(hn::Max(below, above), hn::Zero(d));
}

void find_candidates_simd(const ClusterBounds& all, const Seekers& s, std::vector<ClusterRange>& ranges,
                          Candidates& out) {
  const D d;
  const Indices indices;
  const auto iota = hn::Iota(indices, 0);
  const V lowest = hn::Set(d, s.low[2] - s.range), range2 = hn::Set(d, s.range * s.range);
  const float highest = s.high[2] + s.range;
  const float *z_low = all.low[2].data(), *z_high = all.high[2].data();
  V low[3], high[3];
  for (int k = 0; k < 3; ++k) {
    low[k] = hn::Set(d, s.low[k]);
    high[k] = hn::Set(d, s.high[k]);
  }
  int count = 0;
  for (ClusterRange& range : ranges) {
    for (int behind = kLanes; behind == kLanes && range.begin < range.end; range.begin += behind)
      behind = std::countr_one(bits_of(hn::LoadU(d, z_high + range.begin) < lowest));
    for (int c = range.begin; c < range.end && z_low[c] <= highest; c += kLanes) {
      V gap2 = hn::Zero(d);
      for (int k = 0; k < 3; ++k) {
        const V g = gap(low[k], high[k], all.low[k].data() + c, all.high[k].data() + c);
        gap2 += g * g;
      }
      unsigned near = bits_of(gap2 <= range2);
      if (range.end - c < kLanes) near &= (1u << (range.end - c)) - 1;
      if (near == 0) continue;
      const int first = std::countr_zero(near);
      hn::StoreU(hn::Set(indices, c + first) + iota, indices, out.cluster.data() + count);
      for (std::size_t k = 0; k < all.x.size(); ++k)
        hn::StoreU(hn::LoadU(d, all.x[k].data() + c + first), d, out.x[k].data() + count);
      count += static_cast<int>(std::bit_width(near)) - first;
    }
  }
  out.count = count;
  for (auto& along : out.x) hn::StoreU(hn::Set(d, kNowhere), d, along.data() + count);
}

void find_partners_simd(const Candidates& among, int first, const Seeker& s, Partners& found, int* out) {
  const D d;
  const Indices indices;
  V own[3 * kClusterAtoms];
  for (std::size_t k = 0; k < s.x.size(); ++k) own[k] = hn::Set(d, s.x[k]);
  const V core2 = hn::Set(d, s.core2), farthest2 = hn::Set(d, s.shell2.back());
  const V never = hn::Set(d, std::numeric_limits<float>::max());
  const bool whole = s.row_atoms == kClusterAtoms;
  int* cluster = found.cluster.data();
  float* near2 = found.r2.data();
  int count = 0;
  for (int c = first, end = among.count; c < end; c += kLanes) {
    V half[2] = {never, never};  // of the nearest atom to each half of the seeker's
    for (int j = 0; j < kClusterAtoms; ++j) {
      const V x = hn::LoadU(d, among.x[j].data() + c), y = hn::LoadU(d, among.x[4 + j].data() + c),
              z = hn::LoadU(d, among.x[8 + j].data() + c);
      for (int i = 0; i < kClusterAtoms; ++i) {
        const V dx = own[i] - x, dy = own[4 + i] - y, dz = own[8 + i] - z;
        half[i / 2] = hn::Min(half[i / 2], dz * dz + dy * dy + dx * dx);
      }
    }
    const V nearest = hn::Min(half[0], half[1]), core = whole ? nearest : hn::Max(half[0], half[1]);
    const V r2 = hn::IfThenZeroElse(core <= core2, nearest);
    const auto chosen = hn::And(r2 <= farthest2, hn::FirstN(d, end - c));  // though that be infinite
    hn::StoreU(hn::Compress(r2, chosen), d, near2 + count);
    hn::StoreU(hn::Compress(hn::LoadU(indices, among.cluster.data() + c), hn::RebindMask(indices, chosen)),
               indices, cluster + count);
    count += static_cast<int>(hn::CountTrue(d, chosen));
  }
  hn::StoreU(never, d, near2 + count);
  found.excluded.clear();
  for (const MaskedCluster* e = s.exclude; e != s.end; ++e)
    for (int k = 0; k < count; k += kLanes) {
      const auto it = hn::LoadU(indices, cluster + k) == hn::Set(indices, e->cluster);
      if (hn::AllFalse(indices, it)) continue;
      const auto here = hn::And(hn::RebindMask(d, it), hn::LoadU(d, near2 + k) < never);
      if (hn::AllFalse(d, here)) continue;
      hn::StoreU(hn::IfThenElse(here, never, hn::LoadU(d, near2 + k)), d, near2 + k);
      found.excluded.push_back(*e);
    }
  V inner = hn::Set(d, -1);
  for (int shell = 0; shell <= kShells; ++shell) {
    const V outer = shell == 0 ? hn::Zero(d) : hn::Set(d, s.shell2[shell - 1]);
    const int* begin = out;
    for (int k = 0; k < count; k += kLanes) {
      const V r2 = hn::LoadU(d, near2 + k);
      const auto chosen = hn::And(hn::And(r2 > inner, r2 <= outer), hn::FirstN(d, count - k));
      hn::StoreU(hn::Compress(hn::LoadU(indices, cluster + k), hn::RebindMask(indices, chosen)), indices,
                 out);
      out += hn::CountTrue(d, chosen);
    }
    found.count[shell] = static_cast<int>(out - begin);
    inner = outer;
  }
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

void SideBySide::make_room(int clusters) {
  for (auto& along : x) along.resize(clusters + kSpare);
}

void ClusterBounds::make_room(int clusters) {
  SideBySide::make_room(clusters);
  for (auto* bounds : {&low, &high})
    for (auto& along : *bounds) along.resize(clusters + kSpare);
}

void ClusterBounds::find(const float* rounded, int begin, int end) {
  for (int c = begin; c < end; ++c)
    for (int d = 0; d < 3; ++d) {
      const float* p = rounded + entry(4 * std::ptrdiff_t{c}, d, 4);
      for (int i = 0; i < kClusterAtoms; ++i) x[4 * d + i][c] = p[i];
      low[d][c] = std::min({p[0], p[1], p[2], p[3]});
      high[d][c] = std::max({p[0], p[1], p[2], p[3]});
    }
}

void Candidates::make_room(int clusters) {
  SideBySide::make_room(clusters);
  cluster.resize(clusters + kSpare);
}

void Partners::make_room(int clusters) {
  cluster.resize(clusters + SideBySide::kSpare);
  r2.resize(clusters + SideBySide::kSpare);
}

HWY_EXPORT(find_candidates_simd);
void find_candidates(const ClusterBounds& all, const Seekers& seekers, std::vector<ClusterRange>& ranges,
                     Candidates& out) {
  HWY_DYNAMIC_DISPATCH(find_candidates_simd)(all, seekers, ranges, out);
}
HWY_EXPORT(find_partners_simd);
void find_partners(const Candidates& among, int first, const Seeker& seeker, Partners& found, int* out) {
  HWY_DYNAMIC_DISPATCH(find_partners_simd)(among, first, seeker, found, out);
}

}  // namespace taut
#endif
