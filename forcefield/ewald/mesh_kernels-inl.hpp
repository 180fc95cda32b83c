// The kernels in one precision, TAUT_MESH_REAL: included once by the source file of each.
#include <hwy/cache_control.h>

#include <algorithm>
#include <numeric>

#include "forcefield/ewald/mesh_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/ewald/mesh_kernels-inl.hpp"
#include "base/simd_targets.hpp"
// after the targets: once a target
#include "base/lane_arithmetic-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

using Real = TAUT_MESH_REAL;

// In an unnamed namespace, because types and templates of both precisions have the same names.
namespace {

constexpr int kTogether = 32;      // atoms whose splines are found at a time
using Fours = Real[kTogether][4];  // of each atom, four numbers along an edge

// Spline weights (or slopes) of up to kTogether atoms: along the first two edges one array for each grid
// point, along the third edge in fours, with zeros beyond the order.
template <int order>
struct Numbers {
  static constexpr int kFours = padded_order(order) / 4;
  HWY_ALIGN Real across[2][order][kTogether];
  HWY_ALIGN Fours along[kFours];
};
template <int order>
struct Splines {
  Numbers<order> weight, slope;
};

// Calls kernel<order>(), whose loops have lengths known when compiled.
HWY_INLINE void of_order(int order, const auto& kernel) {
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

using D = hn::ScalableTag<Real>;
using V = hn::Vec<D>;

template <int order>
HWY_INLINE void store(const V* value, int edge, int first, Numbers<order>& out) {
  const D d;
  if (edge < 2) {
#pragma GCC unroll 8
    for (int k = 0; k < order; ++k) hn::Store(value[k], d, out.across[edge][k] + first);
    return;
  }
  const auto of = [&](int k) HWY_ATTR { return k < order ? value[k] : hn::Zero(d); };
#pragma GCC unroll 2
  for (int k = 0; k < order; k += 4)
    hn::StoreInterleaved4(of(k), of(k + 1), of(k + 2), of(k + 3), d, out.along[k / 4][first]);
}

enum class Find { kWeights, kWeightsAndSlopes };

// Slopes come of the weights of one order less, in passing.
template <int order>
HWY_INLINE void find_splines(MeshAtoms<Real> atoms, Find what, Splines<order>& out) {
  const D d;
  HWY_ALIGN Real above[3][kTogether];  // the grid point below each atom, 0 … 1
  for (int edge = 0; edge < 3; ++edge) {
    for (std::size_t a = 0; a < atoms.size(); ++a) above[edge][a] = atoms[a].above[edge];
    std::fill(above[edge] + atoms.size(), std::end(above[edge]), Real(0));
  }
  for (int first = 0; first < static_cast<int>(atoms.size()); first += static_cast<int>(hn::Lanes(d)))
    for (int edge = 0; edge < 3; ++edge) {
      const V w = hn::Load(d, above[edge] + first);
      V value[order];
      value[0] = 1 - w;
      value[1] = w;
#pragma GCC unroll 8
      for (int n = 3; n <= order; ++n) {
        if (n == order && what == Find::kWeightsAndSlopes) {
          V slope[order];
          slope[0] = -value[0];
#pragma GCC unroll 8
          for (int k = 1; k < n - 1; ++k) slope[k] = value[k - 1] - value[k];
          slope[n - 1] = value[n - 2];
          store<order>(slope, edge, first, out.slope);
        }
        const Real inv = Real(1) / Real(n - 1);
        value[n - 1] = inv * w * value[n - 2];
#pragma GCC unroll 8
        for (int k = n - 2; k > 0; --k)
          value[k] = inv * ((Real(k + 1) - w) * value[k] + (w + Real(n - 1 - k)) * value[k - 1]);
        value[0] *= inv * (1 - w);
      }
      store<order>(value, edge, first, out.weight);
    }
}

// The grid points along the third edge that an atom's spline covers, in as few vectors as hold them.
template <int order>
struct GridLine {
  using D = hn::CappedTag<Real, padded_order(order)>;
  static constexpr int kLanes = static_cast<int>(hn::MaxLanes(D())), kVectors = padded_order(order) / kLanes;

  hn::Vec<D> v[kVectors];

  static HWY_INLINE GridLine from(const Real* p) {
    GridLine line;
#pragma GCC unroll 8
    for (int k = 0; k < kVectors; ++k) line.v[k] = hn::LoadU(D(), p + k * kLanes);
    return line;
  }
  // The weights of atom a, which are stored in vectors of four.
  static HWY_INLINE GridLine from(const Fours* fours, int a) {
    GridLine line;
#if HWY_TARGET != HWY_SCALAR
    if constexpr (kLanes == 8) {
      const hn::Half<D> half;
      line.v[0] = hn::Combine(D(), hn::LoadU(half, fours[1][a]), hn::LoadU(half, fours[0][a]));
      return line;
    } else
#endif
#pragma GCC unroll 8
      for (int k = 0; k < kVectors; ++k)
        line.v[k] = hn::LoadU(D(), fours[k * kLanes / 4][a] + k * kLanes % 4);
    return line;
  }
};

// The begin of an atom's rows in each of its planes, one plane after the other.
class PlanesOf {
 public:
  HWY_INLINE PlanesOf(const MeshGrid<Real>& grid, const MeshAtom<Real>& atom)
      : apart_(grid.apart),
        all_(grid.size[0] * grid.apart),
        end_(grid.plane + all_),
        at_(grid.plane + atom.point[0] * grid.apart + atom.point[1] * grid.stride + atom.point[2]) {}
  HWY_INLINE Real* next() {
    Real* const rows = at_;
    at_ = wrapped(at_ + apart_);
    return rows;
  }

 private:
  HWY_INLINE Real* wrapped(Real* at) const { return at < end_ ? at : at - all_; }

  std::ptrdiff_t apart_, all_;
  Real *end_, *at_;
};

// Asks the caches for an atom's rows in the last of its planes: the others serve the atoms before it, too.
template <int order>
HWY_INLINE void prefetch_last_plane(const MeshGrid<Real>& grid, const MeshAtom<Real>& atom) {
  const int last = atom.point[0] + order - 1, plane = last < grid.size[0] ? last : last - grid.size[0];
  const Real* row = grid.plane + plane * grid.apart + atom.point[1] * grid.stride + atom.point[2];
#pragma GCC unroll 8
  for (int j = 0; j < order; ++j, row += grid.stride) hwy::Prefetch(row);
}

template <int order>
HWY_INLINE void spread_of(const MeshGrid<Real>& grid, const PlanesAbove& planes, MeshAtoms<Real> atoms,
                          const Splines<order>& splines) {
  using Line = GridLine<order>;
  const typename Line::D d;
  for (int a = 0; a < static_cast<int>(atoms.size()); ++a) {
    const Line w = Line::from(splines.weight.along, a);
    Line of[order];
#pragma GCC unroll 8
    for (int j = 0; j < order; ++j) {
      const Real c = atoms[a].charge * splines.weight.across[1][j][a];
#pragma GCC unroll 8
      for (int v = 0; v < Line::kVectors; ++v) of[j].v[v] = c * w.v[v];
    }
    PlanesOf all(grid, atoms[a]);
#pragma GCC unroll 8
    for (int k = 0; k < order; ++k) {
      Real* row = all.next();
      if (k < planes.first || k > planes.last) continue;
      const Real c = splines.weight.across[0][k][a];
#pragma GCC unroll 8
      for (int j = 0; j < order; ++j, row += grid.stride)
#pragma GCC unroll 8
        for (int v = 0; v < Line::kVectors; ++v) {
          Real* const at = row + v * Line::kLanes;
          hn::StoreU(hn::LoadU(d, at) + c * of[j].v[v], d, at);
        }
    }
  }
}

// Σ φ dw/du of an atom along the three edges. The sum along a row comes last: first Σ φ w₁w₂, Σ φ dw₁w₂ and
// Σ φ w₁dw₂ for each point of a row.
template <int order>
HWY_INLINE std::array<double, 3> slope_of(const MeshGrid<Real>& grid, const MeshAtom<Real>& atom,
                                          const Splines<order>& splines, int a) {
  using Line = GridLine<order>;
  const typename Line::D d;
  const auto zero = hn::Zero(d);
  PlanesOf planes(grid, atom);
  Line level, first, second;
#pragma GCC unroll 8
  for (int v = 0; v < Line::kVectors; ++v) level.v[v] = first.v[v] = second.v[v] = zero;
#pragma GCC unroll 8
  for (int k = 0; k < order; ++k) {
    const Real* row = planes.next();
    Line of, tilt;
#pragma GCC unroll 8
    for (int v = 0; v < Line::kVectors; ++v) of.v[v] = tilt.v[v] = zero;
#pragma GCC unroll 8
    for (int j = 0; j < order; ++j, row += grid.stride) {
      const Line phi = Line::from(row);
      const Real wj = splines.weight.across[1][j][a], dj = splines.slope.across[1][j][a];
#pragma GCC unroll 8
      for (int v = 0; v < Line::kVectors; ++v) {
        of.v[v] += wj * phi.v[v];
        tilt.v[v] += dj * phi.v[v];
      }
    }
    const Real wk = splines.weight.across[0][k][a], dk = splines.slope.across[0][k][a];
#pragma GCC unroll 8
    for (int v = 0; v < Line::kVectors; ++v) {
      level.v[v] += wk * of.v[v];
      first.v[v] += dk * of.v[v];
      second.v[v] += wk * tilt.v[v];
    }
  }
  const Line w = Line::from(splines.weight.along, a), dw = Line::from(splines.slope.along, a);
  auto x = zero, y = zero, z = zero;
#pragma GCC unroll 8
  for (int v = 0; v < Line::kVectors; ++v) {
    x += first.v[v] * w.v[v];
    y += second.v[v] * w.v[v];
    z += level.v[v] * dw.v[v];
  }
  const auto sum = [&](auto of) HWY_ATTR { return double(hn::GetLane(hn::SumOfLanes(d, of))); };
  return {sum(x), sum(y), sum(z)};
}

// Calls work(some) for up to kTogether atoms at a time.
HWY_INLINE void some_at_a_time(MeshAtoms<Real> atoms, const auto& work) {
  for (; !atoms.empty(); atoms = atoms.subspan(std::min<std::size_t>(kTogether, atoms.size())))
    work(atoms.first(std::min<std::size_t>(kTogether, atoms.size())));
}

}  // namespace

void spread(MeshGrid<Real> grid, const PlanesAbove& planes, MeshAtoms<Real> atoms) {
  of_order(grid.order, [&]<int order>() HWY_ATTR {
    Splines<order> splines;
    some_at_a_time(atoms, [&](MeshAtoms<Real> some) HWY_ATTR {
      find_splines<order>(some, Find::kWeights, splines);
      spread_of<order>(grid, planes, some, splines);
    });
  });
}

void forces(MeshGrid<Real> grid, MeshAtoms<Real> atoms, const Eigen::Matrix3d& grid_gradient, Vectors& f) {
  of_order(grid.order, [&]<int order>() HWY_ATTR {
    Splines<order> splines;
    some_at_a_time(atoms, [&](MeshAtoms<Real> some) HWY_ATTR {
      for (const auto& atom : some) {
        hwy::Prefetch(f.data() + 3 * std::ptrdiff_t{atom.atom});
        prefetch_last_plane<order>(grid, atom);
      }
      find_splines<order>(some, Find::kWeightsAndSlopes, splines);
      for (int a = 0; a < static_cast<int>(some.size()); ++a) {
        const auto slope = slope_of<order>(grid, some[a], splines, a);
        double* const at = f.data() + 3 * std::ptrdiff_t{some[a].atom};
        const double q = double(some[a].charge);
        for (int d = 0; d < 3; ++d)
          at[d] -= q * (grid_gradient(d, 0) * slope[0] + grid_gradient(d, 1) * slope[1] +
                        grid_gradient(d, 2) * slope[2]);
      }
    });
  });
}

// One number for each of the three edges, and a fourth to fill the vector.
namespace {
struct Edges {
  using D = hn::CappedTag<double, 4>;
  static constexpr int kLanes = static_cast<int>(hn::MaxLanes(D())), kVectors = 4 / kLanes;
  hn::Vec<D> v[kVectors];

  HWY_INLINE explicit Edges(const auto& numbers) {
    HWY_ALIGN double all[4] = {double(numbers[0]), double(numbers[1]), double(numbers[2]), 1};
    for (int k = 0; k < kVectors; ++k) v[k] = hn::Load(D(), all + k * kLanes);
  }
};
}  // namespace

void points(const MeshFrame& frame, const Vectors& x, std::span<const Charged> charged, MeshAtom<Real>* out) {
  const Edges size(frame.size),
      along[] = {Edges(frame.into.col(0)), Edges(frame.into.col(1)), Edges(frame.into.col(2))};
  const Edges::D d;
  const hn::Rebind<std::int32_t, Edges::D> whole;
  for (const auto& [atom, charge] : charged) {
    const double* const p = x.data() + 3 * std::ptrdiff_t{atom};
    HWY_ALIGN double above[4];
    HWY_ALIGN std::int32_t point[4];
    for (int v = 0; v < Edges::kVectors; ++v) {
      const auto s = along[2].v[v] * p[2] + along[1].v[v] * p[1] + along[0].v[v] * p[0];
      const auto at = (s - hn::Floor(s)) * size.v[v];
      const auto below = hn::Min(hn::Floor(at), size.v[v] - 1);  // rounding on a wall
      hn::Store(at - below, d, above + v * Edges::kLanes);
      hn::Store(hn::DemoteTo(whole, below), whole, point + v * Edges::kLanes);
    }
    *out++ = {{Real(above[0]), Real(above[1]), Real(above[2])},
              static_cast<Real>(charge),
              {point[0], point[1], point[2]},
              atom};
  }
}

double solve_row(std::span<const Real> factor, std::complex<Real>* z) {
  const D d;
  constexpr int kMost = static_cast<int>(hn::MaxLanes(d));
  const int lanes = static_cast<int>(hn::Lanes(d)), n = static_cast<int>(factor.size());
  double sum[kMost] = {};
  HWY_ALIGN Real part[kMost];
  int k = 0;
  for (; k + lanes <= n; k += lanes) {
    Real* const numbers = reinterpret_cast<Real*>(z + k);
    V re, im;
    hn::LoadInterleaved2(d, numbers, re, im);
    const V g = hn::LoadU(d, &factor[k]);
    hn::StoreInterleaved2(g * re, g * im, d, numbers);
    hn::Store(g * (im * im + re * re), d, part);
    for (int l = 0; l < kMost; ++l) sum[l] += double(part[l]);
  }
  for (; k < n; ++k) {
    sum[0] += double(factor[k] * std::norm(z[k]));
    z[k] *= factor[k];
  }
  return std::accumulate(sum, sum + kMost, 0.0);
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

using Real = TAUT_MESH_REAL;

HWY_EXPORT(points);
HWY_EXPORT(spread);
HWY_EXPORT(forces);
HWY_EXPORT(solve_row);
template <>
void find_points(const MeshFrame& frame, const Vectors& x, std::span<const Charged> charged,
                 MeshAtom<Real>* out) {
  HWY_DYNAMIC_DISPATCH(points)(frame, x, charged, out);
}
template <>
void spread_charges(const MeshGrid<Real>& grid, const PlanesAbove& planes, MeshAtoms<Real> atoms) {
  HWY_DYNAMIC_DISPATCH(spread)(grid, planes, atoms);
}
template <>
void add_mesh_forces(const MeshGrid<Real>& grid, MeshAtoms<Real> atoms, const Eigen::Matrix3d& grid_gradient,
                     Vectors& f) {
  HWY_DYNAMIC_DISPATCH(forces)(grid, atoms, grid_gradient, f);
}
template <>
double solve(std::span<const Real> factor, std::complex<Real>* z) {
  return HWY_DYNAMIC_DISPATCH(solve_row)(factor, z);
}

}  // namespace taut
#endif
