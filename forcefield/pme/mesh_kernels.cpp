#include "forcefield/pme/mesh_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/pme/mesh_kernels.cpp"
#include "forcefield/clusters/simd_targets.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, kMostOrder>;
using V = hn::Vec<D>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(D())), kVectors = kMostOrder / kLanes;

// Three edges at once, and a fourth for the vector's sake.
void splines(int order, const std::array<double, 3>& above, MeshAtom& atom) {
  constexpr int kEdges = 4;
  double w[kEdges] = {above[0], above[1], above[2], 0}, value[kMostOrder][kEdges] = {},
         slope[kMostOrder][kEdges] = {};
  for (int d = 0; d < kEdges; ++d) {
    value[0][d] = 1 - w[d];
    value[1][d] = w[d];
  }
  for (int n = 3; n <= order; ++n) {
    if (n == order)
      for (int k = 0; k < n; ++k)
        for (int d = 0; d < kEdges; ++d) slope[k][d] = (k > 0 ? value[k - 1][d] : 0) - value[k][d];
    const double inv = 1.0 / (n - 1);
    for (int d = 0; d < kEdges; ++d) value[n - 1][d] = inv * w[d] * value[n - 2][d];
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

// The atom's row k of a plane, from its point on.
HWY_INLINE double* row_of(const MeshGrid& grid, double* plane, const MeshAtom& atom, int k) {
  const int row = atom.point[1] + k, wrapped = row < grid.size[1] ? row : row - grid.size[1];
  return plane + std::ptrdiff_t{wrapped} * grid.stride + atom.point[2];
}

HWY_INLINE double* plane_of(const MeshGrid& grid, int k) {
  return grid.plane + std::ptrdiff_t{k} * grid.size[1] * grid.stride;
}

HWY_INLINE void load(const std::array<double, kMostOrder>& from, V (&to)[kVectors]) {
  for (int v = 0; v < kVectors; ++v) to[v] = hn::LoadU(D(), from.data() + v * kLanes);
}

void spread(const MeshGrid& grid, int plane, MeshAtoms atoms, int k) {
  const D d;
  double* const to = plane_of(grid, plane);
  for (const MeshAtom* atom = atoms.begin; atom != atoms.end; ++atom) {
    const double q = atom->charge * atom->weight[0][k];
    V w[kVectors];
    load(atom->weight[2], w);
    for (int j = 0; j < grid.order; ++j) {
      double* row = row_of(grid, to, *atom, j);
      const V c = hn::Set(d, q * atom->weight[1][j]);
      for (int v = 0; v < kVectors; ++v, row += kLanes)
        hn::StoreU(hn::MulAdd(c, w[v], hn::LoadU(d, row)), d, row);
    }
  }
}

// Along a row last: Σ φ w₁w₂, Σ φ dw₁w₂ and Σ φ w₁dw₂ there.
Vec3 slope_of(const MeshGrid& grid, const MeshAtom& atom) {
  const D d;
  V level[kVectors], first[kVectors], second[kVectors], w[kVectors], dw[kVectors];
  for (int v = 0; v < kVectors; ++v) level[v] = first[v] = second[v] = hn::Zero(d);
  for (int k = 0; k < grid.order; ++k) {
    const int above = atom.point[0] + k;
    double* const plane = plane_of(grid, above < grid.size[0] ? above : above - grid.size[0]);
    V of[kVectors], tilt[kVectors];
    for (int v = 0; v < kVectors; ++v) of[v] = tilt[v] = hn::Zero(d);
    for (int j = 0; j < grid.order; ++j) {
      const double* row = row_of(grid, plane, atom, j);
      const V wj = hn::Set(d, atom.weight[1][j]), dj = hn::Set(d, atom.slope[1][j]);
      for (int v = 0; v < kVectors; ++v, row += kLanes) {
        const V phi = hn::LoadU(d, row);
        of[v] = hn::MulAdd(wj, phi, of[v]);
        tilt[v] = hn::MulAdd(dj, phi, tilt[v]);
      }
    }
    const V wk = hn::Set(d, atom.weight[0][k]), dk = hn::Set(d, atom.slope[0][k]);
    for (int v = 0; v < kVectors; ++v) {
      level[v] = hn::MulAdd(wk, of[v], level[v]);
      first[v] = hn::MulAdd(dk, of[v], first[v]);
      second[v] = hn::MulAdd(wk, tilt[v], second[v]);
    }
  }
  load(atom.weight[2], w);
  load(atom.slope[2], dw);
  V x = hn::Zero(d), y = x, z = x;
  for (int v = 0; v < kVectors; ++v) {
    x = hn::MulAdd(first[v], w[v], x);
    y = hn::MulAdd(second[v], w[v], y);
    z = hn::MulAdd(level[v], dw[v], z);
  }
  return {hn::GetLane(hn::SumOfLanes(d, x)), hn::GetLane(hn::SumOfLanes(d, y)),
          hn::GetLane(hn::SumOfLanes(d, z))};
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
