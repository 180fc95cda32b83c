#include "forcefield/pme/mesh_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/pme/mesh_kernels.cpp"
#include "forcefield/clusters/simd_targets.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A row of weights: as few vectors as hold the order.
template <int order>
struct RowOf {
  static constexpr int kRoom = order <= 4 ? 4 : kMostOrder;
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

// Three edges at once, and a fourth for the vector's sake.
template <int order>
HWY_INLINE void splines_of(const std::array<double, 3>& above, MeshAtom& atom) {
  constexpr int kEdges = 4;
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
  for (int d = 0; d < 3; ++d)
    for (int k = 0; k < kMostOrder; ++k) {
      atom.weight[d][k] = value[k][d];
      atom.slope[d][k] = slope[k][d];
    }
}

void splines(int order, const std::array<double, 3>& above, MeshAtom& atom) {
  of_order(order, [&]<int kOrder>() HWY_ATTR { splines_of<kOrder>(above, atom); });
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
HWY_INLINE void spread_of(const MeshGrid& grid, int plane, MeshAtoms atoms, int k) {
  using Row = RowOf<order>;
  const typename Row::D d;
  double* const to = plane_of(grid, plane);
  for (const MeshAtom* atom = atoms.begin; atom != atoms.end; ++atom) {
    const double q = atom->charge * atom->weight[0][k];
    const Row w = Row::from(atom->weight[2].data());
    for (int j = 0; j < order; ++j) {
      double* row = row_of(grid, to, *atom, j);
      const auto c = hn::Set(d, q * atom->weight[1][j]);
      for (int v = 0; v < Row::kVectors; ++v, row += Row::kLanes)
        hn::StoreU(hn::MulAdd(c, w.v[v], hn::LoadU(d, row)), d, row);
    }
  }
}

void spread(const MeshGrid& grid, int plane, MeshAtoms atoms, int k) {
  of_order(grid.order, [&]<int kOrder>() HWY_ATTR { spread_of<kOrder>(grid, plane, atoms, k); });
}

// Along a row last: Σ φ w₁w₂, Σ φ dw₁w₂ and Σ φ w₁dw₂ there.
template <int order>
HWY_INLINE Vec3 slope_of_order(const MeshGrid& grid, const MeshAtom& atom) {
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
      const auto wj = hn::Set(d, atom.weight[1][j]), dj = hn::Set(d, atom.slope[1][j]);
      for (int v = 0; v < Row::kVectors; ++v) {
        of.v[v] = hn::MulAdd(wj, phi.v[v], of.v[v]);
        tilt.v[v] = hn::MulAdd(dj, phi.v[v], tilt.v[v]);
      }
    }
    const auto wk = hn::Set(d, atom.weight[0][k]), dk = hn::Set(d, atom.slope[0][k]);
    for (int v = 0; v < Row::kVectors; ++v) {
      level.v[v] = hn::MulAdd(wk, of.v[v], level.v[v]);
      first.v[v] = hn::MulAdd(dk, of.v[v], first.v[v]);
      second.v[v] = hn::MulAdd(wk, tilt.v[v], second.v[v]);
    }
  }
  const Row w = Row::from(atom.weight[2].data()), dw = Row::from(atom.slope[2].data());
  auto x = zero, y = zero, z = zero;
  for (int v = 0; v < Row::kVectors; ++v) {
    x = hn::MulAdd(first.v[v], w.v[v], x);
    y = hn::MulAdd(second.v[v], w.v[v], y);
    z = hn::MulAdd(level.v[v], dw.v[v], z);
  }
  return {hn::GetLane(hn::SumOfLanes(d, x)), hn::GetLane(hn::SumOfLanes(d, y)),
          hn::GetLane(hn::SumOfLanes(d, z))};
}

Vec3 slope_of(const MeshGrid& grid, const MeshAtom& atom) {
  return of_order(grid.order, [&]<int kOrder>() HWY_ATTR { return slope_of_order<kOrder>(grid, atom); });
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(splines);
HWY_EXPORT(spread);
HWY_EXPORT(slope_of);
void find_splines(int order, const std::array<double, 3>& above, MeshAtom& atom) {
  HWY_DYNAMIC_DISPATCH(splines)(order, above, atom);
}
void spread_charges(const MeshGrid& grid, int plane, MeshAtoms atoms, int k) {
  HWY_DYNAMIC_DISPATCH(spread)(grid, plane, atoms, k);
}
Vec3 slope_at(const MeshGrid& grid, const MeshAtom& atom) {
  return HWY_DYNAMIC_DISPATCH(slope_of)(grid, atom);
}

}  // namespace taut
#endif
