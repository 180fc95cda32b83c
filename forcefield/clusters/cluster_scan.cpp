#include "forcefield/clusters/cluster_scan.hpp"

#include <algorithm>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/clusters/cluster_scan.cpp"
#include "forcefield/clusters/simd_targets.hpp"
// after the targets: once a target
#include "forcefield/clusters/in_range-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(D()));

// How far [low, high] is from each of the intervals of the clusters.
V gap(V low, V high, const float* lows, const float* highs) {
  const D d;
  const V below = hn::Sub(low, hn::LoadU(d, highs)), above = hn::Sub(hn::LoadU(d, lows), high);
  return hn::Max(hn::Max(below, above), hn::Zero(d));
}

void scan_clusters_simd(ClusterScan& s, const ClusterRange* ranges, int ranges_count) {
  const D d;
  const hn::Rebind<std::int32_t, D> indices;
  const auto first = hn::Iota(indices, 0);
  const float highest = s.own_high[2] + static_cast<float>(s.reach);
  const V reach2 = hn::Set(d, static_cast<float>(s.reach * s.reach));
  V low[3], high[3];
  for (int k = 0; k < 3; ++k) {
    low[k] = hn::Set(d, s.own_low[k]);
    high[k] = hn::Set(d, s.own_high[k]);
  }
  // first by bounds; without branches, which would often be guessed wrong
  int* candidate = s.candidates;
  for (const ClusterRange* range = ranges; range != ranges + ranges_count; ++range)
    for (int c = range->begin; c < range->end && s.low[2][c] <= highest; c += kLanes) {
      const V gx = gap(low[0], high[0], s.low[0] + c, s.high[0] + c);
      const V gy = gap(low[1], high[1], s.low[1] + c, s.high[1] + c);
      const V gz = gap(low[2], high[2], s.low[2] + c, s.high[2] + c);
      const V gap2 = hn::MulAdd(gx, gx, hn::MulAdd(gy, gy, hn::Mul(gz, gz)));
      std::uint64_t near = 0;
      hn::StoreMaskBits(d, hn::Le(gap2, reach2), reinterpret_cast<std::uint8_t*>(&near));
      auto bits = static_cast<unsigned>(near);
      if (range->end - c < kLanes) bits &= (1u << (range->end - c)) - 1;
      candidate = store_those(indices, hn::Add(hn::Set(indices, c), first), bits, candidate);
    }
  // then by atoms
  InRange in_range(s.x, s.range);
  in_range.take(s.own, s.shift);
  int* found[] = {s.found};
  in_range.choose(s.candidates, static_cast<int>(candidate - s.candidates), found);
  s.count = static_cast<int>(found[0] - s.found);
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {
HWY_EXPORT(scan_clusters_simd);
void scan_clusters(ClusterScan& scan, const ClusterRange* ranges, int count) {
  HWY_DYNAMIC_DISPATCH(scan_clusters_simd)(scan, ranges, count);
}
}  // namespace taut
#endif
