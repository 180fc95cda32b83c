#include "forcefield/clusters/cluster_scan.hpp"

#include <algorithm>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/clusters/cluster_scan.cpp"
#include "forcefield/clusters/simd_targets.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(D()));

// How far [low, high] is from each of the intervals of the clusters.
V gap(V low, V high, const double* lows, const double* highs) {
  const D d;
  const V below = hn::Sub(low, hn::LoadU(d, highs)), above = hn::Sub(hn::LoadU(d, lows), high);
  return hn::Max(hn::Max(below, above), hn::Zero(d));
}

// Atoms of one vector against the four of a cluster: whether any pair is within range. Vectors hold
// 8/4 = 2 atoms by four, or one by four, or one by two.
constexpr int kColumns = kLanes < 4 ? kLanes : 4, kRows = kLanes / kColumns;

HWY_INLINE V load_four(const double* p) {
  const D d;
#if HWY_TARGET <= HWY_AVX3
  return V{_mm512_broadcast_f64x4(_mm256_loadu_pd(p))};
#else
  return hn::LoadU(d, p);
#endif
}

struct Own {  // the searching cluster's atoms, spread over vectors
  V x[4 / kRows], y[4 / kRows], z[4 / kRows];
};

HWY_INLINE Own spread(const double* own) {
  const D d;
  HWY_ALIGN double lane[kLanes];
  Own out;
  const auto spread_one = [&](const double* p, int v) HWY_ATTR {
    for (int l = 0; l < kLanes; ++l) lane[l] = p[v * kRows + l / kColumns];
    return hn::Load(d, lane);
  };
  for (int v = 0; v < 4 / kRows; ++v) {
    out.x[v] = spread_one(own, v);
    out.y[v] = spread_one(own + 4, v);
    out.z[v] = spread_one(own + 8, v);
  }
  return out;
}

HWY_INLINE bool near(const Own& own, int v, const double* x, V range2) {
  const D d;
  bool any = false;
  for (int c = 0; c < 4; c += kColumns) {
    const V dx = hn::Sub(own.x[v], load_four(x + c)), dy = hn::Sub(own.y[v], load_four(x + 4 + c)),
            dz = hn::Sub(own.z[v], load_four(x + 8 + c));
    any |= !hn::AllFalse(d, hn::Le(hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))), range2));
  }
  return any;
}

void scan_clusters_simd(ClusterScan& s, const ClusterRange* ranges, int ranges_count) {
  const D d;
  const double highest = s.own_high[2] + s.range;
  const V range2 = hn::Set(d, s.range * s.range);
  V low[3], high[3];
  for (int k = 0; k < 3; ++k) {
    low[k] = hn::Set(d, s.own_low[k]);
    high[k] = hn::Set(d, s.own_high[k]);
  }
  const Own own = spread(s.own_x);
  // first by bounds; without branches, which would often be guessed wrong
  int* candidate = s.candidates;
  for (const ClusterRange* range = ranges; range != ranges + ranges_count; ++range)
    for (int c = range->begin; c < range->end && s.low[2][c] <= highest; c += kLanes) {
      const V gx = gap(low[0], high[0], s.low[0] + c, s.high[0] + c);
      const V gy = gap(low[1], high[1], s.low[1] + c, s.high[1] + c);
      const V gz = gap(low[2], high[2], s.low[2] + c, s.high[2] + c);
      const V gap2 = hn::MulAdd(gx, gx, hn::MulAdd(gy, gy, hn::Mul(gz, gz)));
      std::uint8_t bytes[8] = {};
      hn::StoreMaskBits(d, hn::Le(gap2, range2), bytes);
      unsigned bits = bytes[0];
      if (range->end - c < kLanes) bits &= (1u << (range->end - c)) - 1;
      for (int l = 0; l < kLanes; ++l) {
        *candidate = c + l;
        candidate += (bits >> l) & 1;
      }
    }
  // then by atoms
  constexpr int kVectors = 4 / kRows;  // of a cluster
  int *found0 = s.found[0], *found1 = s.found[1];
  const bool together = s.row_atoms == 4;
  for (const int* j = s.candidates; j != candidate; ++j) {
    bool half[2] = {false, false};
    for (int v = 0; v < kVectors; ++v) half[2 * v / kVectors] |= near(own, v, s.x + 12 * *j, range2);
    *found0 = *found1 = *j;
    found0 += half[0] | (together & half[1]);
    found1 += half[1];
  }
  s.count[0] = static_cast<int>(found0 - s.found[0]);
  s.count[1] = static_cast<int>(found1 - s.found[1]);
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
