#include "forcefield/pme/mesh_kernels.hpp"

#include <hwy/cache_control.h>

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/pme/mesh_kernels.cpp"
#include "forcefield/clusters/simd_targets.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A row of weights: as few vectors as hold the order.
template <int order>
struct RowOf {
  static constexpr int kRoom = MeshSplines::room(order);
  using D = hn::CappedTag<double, kRoom>;
  using V = hn::Vec<D>;
  static constexpr int kLanes = static_cast<int>(hn::MaxLanes(D())), kVectors = kRoom / kLanes;

  V v[kVectors];
  static HWY_INLINE RowOf from(const double* p) {
    RowOf row;
    for (int k = 0; k < kVectors; ++k) row.v[k] = hn::LoadU(D(), p + k * kLanes);
    return row;
  }
};

// kernel<order>(): loops that are known when compiled.
HWY_INLINE auto of_order(int order, const auto& kernel) {
  switch (order) {
    case 4:
      return kernel.template operator()<4>();
    case 5:
      return kernel.template operator()<5>();
    case 6:
      return kernel.template operator()<6>();
    case 7:
      return kernel.template operator()<7>();
    default:
      return kernel.template operator()<8>();
  }
}

constexpr int kEdges = 4;  // three, and a fourth for the vector's sake

// out[edge][k] = in[k][edge]
template <int room>
HWY_INLINE void turn(const double (&in)[kMostOrder][kEdges], double* out) {
#if HWY_TARGET != HWY_SCALAR
  const hn::CappedTag<double, 4> d;
  if constexpr (hn::MaxLanes(d) == 4) {
    for (int k = 0; k < room; k += 4, out += 4) {
      const auto a = hn::LoadU(d, in[k]), b = hn::LoadU(d, in[k + 1]), c = hn::LoadU(d, in[k + 2]),
                 e = hn::LoadU(d, in[k + 3]);
      const auto even = hn::InterleaveLower(d, a, b), odd = hn::InterleaveUpper(d, a, b),
                 even_after = hn::InterleaveLower(d, c, e), odd_after = hn::InterleaveUpper(d, c, e);
      hn::StoreU(hn::ConcatLowerLower(d, even_after, even), d, out);
      hn::StoreU(hn::ConcatLowerLower(d, odd_after, odd), d, out + room);
      hn::StoreU(hn::ConcatUpperUpper(d, even_after, even), d, out + 2 * room);
    }
    return;
  }
#endif
  for (int edge = 0; edge < 3; ++edge)
    for (int k = 0; k < room; ++k) out[room * edge + k] = in[k][edge];
}

template <int order>
HWY_INLINE void splines_of(const std::array<double, 3>& above, double* weight, double* its_slope) {
  double w[kEdges] = {above[0], above[1], above[2], 0}, value[kMostOrder][kEdges] = {},
         slope[kMostOrder][kEdges] = {};
  for (int d = 0; d < kEdges; ++d) {
    value[0][d] = 1 - w[d];
    value[1][d] = w[d];
  }
#pragma GCC unroll 8
  for (int n = 3; n <= order; ++n) {
    if (n == order)
#pragma GCC unroll 8
      for (int k = 0; k < n; ++k)
        for (int d = 0; d < kEdges; ++d) slope[k][d] = (k > 0 ? value[k - 1][d] : 0) - value[k][d];
    const double inv = 1.0 / (n - 1);
    for (int d = 0; d < kEdges; ++d) value[n - 1][d] = inv * w[d] * value[n - 2][d];
#pragma GCC unroll 8
    for (int k = n - 2; k > 0; --k)
      for (int d = 0; d < kEdges; ++d)
        value[k][d] = inv * ((w[d] + (n - 1 - k)) * value[k - 1][d] + (k + 1 - w[d]) * value[k][d]);
    for (int d = 0; d < kEdges; ++d) value[0][d] *= inv * (1 - w[d]);
  }
  turn<MeshSplines::room(order)>(value, weight);
  turn<MeshSplines::room(order)>(slope, its_slope);
}

void splines(int order, const AbovePoints& atoms, const MeshSplines& splines) {
  of_order(order, [&]<int kOrder>() HWY_ATTR {
    constexpr int kNumbers = 3 * MeshSplines::room(kOrder), kAhead = 16;  // asked for: places lie anywhere
    for (int c = 0; c < atoms.count; ++c) {
      const std::ptrdiff_t ahead =
          kNumbers * std::ptrdiff_t{atoms.place[std::min(c + kAhead, atoms.count - 1)]};
      for (int n = 0; n < kNumbers; n += 8) {
        hwy::Prefetch(splines.weight + ahead + n);
        hwy::Prefetch(splines.slope + ahead + n);
      }
      const std::ptrdiff_t at = kNumbers * std::ptrdiff_t{atoms.place[c]};
      splines_of<kOrder>(atoms.above[c], splines.weight + at, splines.slope + at);
    }
  });
}

// The atom's row k of a plane, from its point on.
HWY_INLINE double* row_of(const MeshGrid& grid, double* plane, const MeshAtom& atom, int k) {
  const int row = atom.point[1] + k, wrapped = row < grid.size[1] ? row : row - grid.size[1];
  return plane + std::ptrdiff_t{wrapped} * grid.stride + atom.point[2];
}

HWY_INLINE double* plane_of(const MeshGrid& grid, int k) {
  return grid.plane + std::ptrdiff_t{k} * grid.size[1] * grid.stride;
}

template <int order>
HWY_INLINE void spread_of(const MeshGrid& grid, int plane, const MeshAtoms& atoms, int k) {
  using Row = RowOf<order>;
  const typename Row::D d;
  double* const to = plane_of(grid, plane);
  const double* weight = atoms.splines.weight + std::ptrdiff_t{atoms.begin} * 3 * Row::kRoom;
  for (int a = atoms.begin; a < atoms.end; ++a, weight += 3 * Row::kRoom) {
    const MeshAtom& atom = atoms.atom[a];
    const double q = atom.charge * weight[k];
    const Row w = Row::from(weight + 2 * Row::kRoom);
    for (int j = 0; j < order; ++j) {
      double* row = row_of(grid, to, atom, j);
      const auto c = hn::Set(d, q * weight[Row::kRoom + j]);
      for (int v = 0; v < Row::kVectors; ++v, row += Row::kLanes)
        hn::StoreU(hn::MulAdd(c, w.v[v], hn::LoadU(d, row)), d, row);
    }
  }
}

void spread(const MeshGrid& grid, int plane, const MeshAtoms& atoms, int k) {
  of_order(grid.order, [&]<int kOrder>() HWY_ATTR { spread_of<kOrder>(grid, plane, atoms, k); });
}

// Along a row last: Σ φ w₁w₂, Σ φ dw₁w₂ and Σ φ w₁dw₂ there.
template <int order>
HWY_INLINE Vec3 slope_of(const MeshGrid& grid, const MeshAtom& atom, const double* weight,
                         const double* slope) {
  using Row = RowOf<order>;
  const typename Row::D d;
  const auto zero = hn::Zero(d);
  Row level, first, second;
  for (int v = 0; v < Row::kVectors; ++v) level.v[v] = first.v[v] = second.v[v] = zero;
  for (int k = 0; k < order; ++k) {
    const int above = atom.point[0] + k;
    double* const plane = plane_of(grid, above < grid.size[0] ? above : above - grid.size[0]);
    Row of, tilt;
    for (int v = 0; v < Row::kVectors; ++v) of.v[v] = tilt.v[v] = zero;
    for (int j = 0; j < order; ++j) {
      const Row phi = Row::from(row_of(grid, plane, atom, j));
      const auto wj = hn::Set(d, weight[Row::kRoom + j]), dj = hn::Set(d, slope[Row::kRoom + j]);
      for (int v = 0; v < Row::kVectors; ++v) {
        of.v[v] = hn::MulAdd(wj, phi.v[v], of.v[v]);
        tilt.v[v] = hn::MulAdd(dj, phi.v[v], tilt.v[v]);
      }
    }
    const auto wk = hn::Set(d, weight[k]), dk = hn::Set(d, slope[k]);
    for (int v = 0; v < Row::kVectors; ++v) {
      level.v[v] = hn::MulAdd(wk, of.v[v], level.v[v]);
      first.v[v] = hn::MulAdd(dk, of.v[v], first.v[v]);
      second.v[v] = hn::MulAdd(wk, tilt.v[v], second.v[v]);
    }
  }
  const Row w = Row::from(weight + 2 * Row::kRoom), dw = Row::from(slope + 2 * Row::kRoom);
  auto x = zero, y = zero, z = zero;
  for (int v = 0; v < Row::kVectors; ++v) {
    x = hn::MulAdd(first.v[v], w.v[v], x);
    y = hn::MulAdd(second.v[v], w.v[v], y);
    z = hn::MulAdd(level.v[v], dw.v[v], z);
  }
  return {hn::GetLane(hn::SumOfLanes(d, x)), hn::GetLane(hn::SumOfLanes(d, y)),
          hn::GetLane(hn::SumOfLanes(d, z))};
}

void slopes(const MeshGrid& grid, const MeshAtoms& atoms, Vec3* slope) {
  of_order(grid.order, [&]<int kOrder>() HWY_ATTR {
    for (int a = atoms.begin; a < atoms.end; ++a) {
      const std::ptrdiff_t at = 3 * MeshSplines::room(kOrder) * std::ptrdiff_t{a};
      *slope++ = slope_of<kOrder>(grid, atoms.atom[a], atoms.splines.weight + at, atoms.splines.slope + at);
    }
  });
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(splines);
HWY_EXPORT(spread);
HWY_EXPORT(slopes);
void find_splines(int order, const AbovePoints& atoms, const MeshSplines& to) {
  HWY_DYNAMIC_DISPATCH(splines)(order, atoms, to);
}
void spread_charges(const MeshGrid& grid, int plane, const MeshAtoms& atoms, int k) {
  HWY_DYNAMIC_DISPATCH(spread)(grid, plane, atoms, k);
}
void find_slopes(const MeshGrid& grid, const MeshAtoms& atoms, Vec3* slope) {
  HWY_DYNAMIC_DISPATCH(slopes)(grid, atoms, slope);
}

}  // namespace taut
#endif
