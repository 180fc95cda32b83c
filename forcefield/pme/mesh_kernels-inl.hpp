// The kernels in one precision, TAUT_MESH_REAL: included once by the source file of each.
#include <hwy/cache_control.h>

#include <algorithm>
#include <numeric>

#include "forcefield/pme/mesh_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/pme/mesh_kernels-inl.hpp"
#include "forcefield/clusters/simd_targets.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Real = TAUT_MESH_REAL;

constexpr int kTogether = 32;      // atoms whose splines are found at a time
using Fours = Real[kTogether][4];  // of each atom, four numbers along an edge
constexpr int room(int order) {
  return order <= 4 ? 4 : kMostOrder;
}

// Weights of atoms along each edge, in fours, zeros beyond the order; and their slopes.
template <int order>
struct Splines {
  static constexpr int kFours = room(order) / 4;
  HWY_ALIGN Fours weight[3][kFours], slope[3][kFours];
};

// kernel<order>(): loops that are known when compiled.
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
HWY_INLINE void store_fours(const V* value, int first, Fours* out) {
  const D d;
  const auto of = [&](int k) HWY_ATTR { return k < order ? value[k] : hn::Zero(d); };
#pragma GCC unroll 2
  for (int k = 0; k < order; k += 4)
    hn::StoreInterleaved4(of(k), of(k + 1), of(k + 2), of(k + 3), d, out[k / 4][first]);
}

template <int order>
HWY_INLINE void find_splines(MeshAtoms<Real> atoms, bool slopes, Splines<order>& out) {
  const D d;
  HWY_ALIGN Real above[3][kTogether] = {};
  for (std::size_t a = 0; a < atoms.size(); ++a)
    for (int edge = 0; edge < 3; ++edge) above[edge][a] = atoms[a].above[edge];
  const auto one = hn::Set(d, 1);
  for (int first = 0; first < static_cast<int>(atoms.size()); first += static_cast<int>(hn::Lanes(d)))
    for (int edge = 0; edge < 3; ++edge) {
      const V w = hn::Load(d, above[edge] + first);
      V value[order];
      value[0] = hn::Sub(one, w);
      value[1] = w;
#pragma GCC unroll 8
      for (int n = 3; n <= order; ++n) {
        if (n == order && slopes) {
          V slope[order];
          slope[0] = hn::Neg(value[0]);
#pragma GCC unroll 8
          for (int k = 1; k < n - 1; ++k) slope[k] = hn::Sub(value[k - 1], value[k]);
          slope[n - 1] = value[n - 2];
          store_fours<order>(slope, first, out.slope[edge]);
        }
        const auto whole = [&](int k) HWY_ATTR { return hn::Set(d, Real(k)); };
        const V inv = hn::Set(d, Real(1) / Real(n - 1));
        value[n - 1] = hn::Mul(hn::Mul(inv, w), value[n - 2]);
#pragma GCC unroll 8
        for (int k = n - 2; k > 0; --k)
          value[k] = hn::Mul(inv, hn::MulAdd(hn::Add(w, whole(n - 1 - k)), value[k - 1],
                                             hn::Mul(hn::Sub(whole(k + 1), w), value[k])));
        value[0] = hn::Mul(value[0], hn::Mul(inv, hn::Sub(one, w)));
      }
      store_fours<order>(value, first, out.weight[edge]);
    }
}

// A row along the third edge: as few vectors as hold the order.
template <int order>
struct RowOf {
  using D = hn::CappedTag<Real, room(order)>;
  static constexpr int kLanes = static_cast<int>(hn::MaxLanes(D())), kVectors = room(order) / kLanes;

  hn::Vec<D> v[kVectors];

  static HWY_INLINE RowOf from(const Real* p) {
    RowOf row;
#pragma GCC unroll 8
    for (int k = 0; k < kVectors; ++k) row.v[k] = hn::LoadU(D(), p + k * kLanes);
    return row;
  }
  // An atom's, in fours.
  static HWY_INLINE RowOf from(const Fours* fours, int a) {
    RowOf row;
#if HWY_TARGET != HWY_SCALAR
    if constexpr (kLanes == 8) {
      const hn::Half<D> half;
      row.v[0] = hn::Combine(D(), hn::LoadU(half, fours[1][a]), hn::LoadU(half, fours[0][a]));
      return row;
    } else
#endif
#pragma GCC unroll 8
      for (int k = 0; k < kVectors; ++k) row.v[k] = hn::LoadU(D(), fours[k * kLanes / 4][a] + k * kLanes % 4);
    return row;
  }
};

// Number k of an atom's.
HWY_INLINE Real number(const Fours* fours, int a, int k) {
  return fours[k / 4][a][k % 4];
}

// Where an atom's rows in a plane begin.
template <int order>
struct RowsOf {
  std::ptrdiff_t at[order];

  HWY_INLINE RowsOf(const MeshGrid<Real>& grid, const MeshAtom<Real>& atom) {
#pragma GCC unroll 8
    for (int j = 0; j < order; ++j) {
      const int row = atom.point[1] + j, wrapped = row < grid.size[1] ? row : row - grid.size[1];
      at[j] = std::ptrdiff_t{wrapped} * grid.stride + atom.point[2];
    }
  }
};

// The atom's planes, one after the other.
class PlanesOf {
 public:
  HWY_INLINE PlanesOf(const MeshGrid<Real>& grid, const MeshAtom<Real>& atom)
      : apart_(std::ptrdiff_t{grid.size[1]} * grid.stride),
        at_(grid.plane + atom.point[0] * apart_),
        end_(grid.plane + grid.size[0] * apart_),
        first_(grid.plane) {}
  HWY_INLINE Real* next() {
    Real* const plane = at_;
    at_ += apart_;
    at_ = at_ < end_ ? at_ : first_;
    return plane;
  }

 private:
  std::ptrdiff_t apart_;
  Real *at_, *end_, *first_;
};

template <int order>
HWY_INLINE void spread_of(const MeshGrid<Real>& grid, const PlanesAbove& planes, MeshAtoms<Real> atoms,
                          const Splines<order>& splines) {
  using Row = RowOf<order>;
  const typename Row::D d;
  for (int a = 0; a < static_cast<int>(atoms.size()); ++a) {
    const RowsOf<order> rows(grid, atoms[a]);
    const Row w = Row::from(splines.weight[2], a);
    Row of[order];
#pragma GCC unroll 8
    for (int j = 0; j < order; ++j) {
      const auto c = hn::Set(d, number(splines.weight[1], a, j));
#pragma GCC unroll 8
      for (int v = 0; v < Row::kVectors; ++v) of[j].v[v] = hn::Mul(c, w.v[v]);
    }
    PlanesOf all(grid, atoms[a]);
#pragma GCC unroll 8
    for (int k = 0; k < order; ++k) {
      Real* const plane = all.next();
      if (k < planes.first || k > planes.last) continue;
      const auto c = hn::Set(d, atoms[a].charge * number(splines.weight[0], a, k));
#pragma GCC unroll 8
      for (int j = 0; j < order; ++j) {
        Real* row = plane + rows.at[j];
#pragma GCC unroll 8
        for (int v = 0; v < Row::kVectors; ++v, row += Row::kLanes)
          hn::StoreU(hn::MulAdd(c, of[j].v[v], hn::LoadU(d, row)), d, row);
      }
    }
  }
}

// Along a row last: Σ φ w₁w₂, Σ φ dw₁w₂ and Σ φ w₁dw₂ there.
template <int order>
HWY_INLINE Vec3 slope_of(const MeshGrid<Real>& grid, const MeshAtom<Real>& atom,
                         const Splines<order>& splines, int a) {
  using Row = RowOf<order>;
  const typename Row::D d;
  const auto zero = hn::Zero(d);
  const RowsOf<order> rows(grid, atom);
  PlanesOf planes(grid, atom);
  Row level, first, second;
#pragma GCC unroll 8
  for (int v = 0; v < Row::kVectors; ++v) level.v[v] = first.v[v] = second.v[v] = zero;
#pragma GCC unroll 8
  for (int k = 0; k < order; ++k) {
    const Real* const plane = planes.next();
    Row of, tilt;
#pragma GCC unroll 8
    for (int v = 0; v < Row::kVectors; ++v) of.v[v] = tilt.v[v] = zero;
#pragma GCC unroll 8
    for (int j = 0; j < order; ++j) {
      const Row phi = Row::from(plane + rows.at[j]);
      const auto wj = hn::Set(d, number(splines.weight[1], a, j)),
                 dj = hn::Set(d, number(splines.slope[1], a, j));
#pragma GCC unroll 8
      for (int v = 0; v < Row::kVectors; ++v) {
        of.v[v] = hn::MulAdd(wj, phi.v[v], of.v[v]);
        tilt.v[v] = hn::MulAdd(dj, phi.v[v], tilt.v[v]);
      }
    }
    const auto wk = hn::Set(d, number(splines.weight[0], a, k)),
               dk = hn::Set(d, number(splines.slope[0], a, k));
#pragma GCC unroll 8
    for (int v = 0; v < Row::kVectors; ++v) {
      level.v[v] = hn::MulAdd(wk, of.v[v], level.v[v]);
      first.v[v] = hn::MulAdd(dk, of.v[v], first.v[v]);
      second.v[v] = hn::MulAdd(wk, tilt.v[v], second.v[v]);
    }
  }
  const Row w = Row::from(splines.weight[2], a), dw = Row::from(splines.slope[2], a);
  auto x = zero, y = zero, z = zero;
#pragma GCC unroll 8
  for (int v = 0; v < Row::kVectors; ++v) {
    x = hn::MulAdd(first.v[v], w.v[v], x);
    y = hn::MulAdd(second.v[v], w.v[v], y);
    z = hn::MulAdd(level.v[v], dw.v[v], z);
  }
  return {hn::GetLane(hn::SumOfLanes(d, x)), hn::GetLane(hn::SumOfLanes(d, y)),
          hn::GetLane(hn::SumOfLanes(d, z))};
}

// work(some) of all of them.
HWY_INLINE void some_at_a_time(MeshAtoms<Real> atoms, const auto& work) {
  for (; !atoms.empty(); atoms = atoms.subspan(std::min<std::size_t>(kTogether, atoms.size())))
    work(atoms.first(std::min<std::size_t>(kTogether, atoms.size())));
}

void spread(const MeshGrid<Real>& grid, const PlanesAbove& planes, MeshAtoms<Real> atoms) {
  of_order(grid.order, [&]<int order>() HWY_ATTR {
    Splines<order> splines;
    some_at_a_time(atoms, [&](MeshAtoms<Real> some) HWY_ATTR {
      find_splines<order>(some, false, splines);
      spread_of<order>(grid, planes, some, splines);
    });
  });
}

void slopes(const MeshGrid<Real>& grid, MeshAtoms<Real> atoms, Vec3* slope) {
  of_order(grid.order, [&]<int order>() HWY_ATTR {
    Splines<order> splines;
    some_at_a_time(atoms, [&](MeshAtoms<Real> some) HWY_ATTR {
      find_splines<order>(some, true, splines);
      for (int a = 0; a < static_cast<int>(some.size()); ++a)
        *slope++ = slope_of<order>(grid, some[a], splines, a);
    });
  });
}

// The three edges, and a fourth for the vector's sake.
struct Edges {
  using D = hn::CappedTag<double, 4>;
  static constexpr int kLanes = static_cast<int>(hn::MaxLanes(D())), kVectors = 4 / kLanes;
  hn::Vec<D> v[kVectors];

  HWY_INLINE explicit Edges(const auto& numbers) {
    HWY_ALIGN double all[4] = {double(numbers[0]), double(numbers[1]), double(numbers[2]), 1};
    for (int k = 0; k < kVectors; ++k) v[k] = hn::Load(D(), all + k * kLanes);
  }
};

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
      const auto s =
          hn::MulAdd(along[0].v[v], hn::Set(d, p[0]),
                     hn::MulAdd(along[1].v[v], hn::Set(d, p[1]), hn::Mul(along[2].v[v], hn::Set(d, p[2]))));
      const auto at = hn::Mul(hn::Sub(s, hn::Floor(s)), size.v[v]);
      const auto below = hn::Min(hn::Floor(at), hn::Sub(size.v[v], hn::Set(d, 1)));  // rounding on a wall
      hn::Store(hn::Sub(at, below), d, above + v * Edges::kLanes);
      hn::Store(hn::DemoteTo(whole, below), whole, point + v * Edges::kLanes);
    }
    *out++ = {{Real(above[0]), Real(above[1]), Real(above[2])},
              static_cast<Real>(charge),
              {point[0], point[1], point[2]},
              atom};
  }
}

double filter_all(std::span<const Real> factor, std::complex<Real>* z) {
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
    hn::StoreInterleaved2(hn::Mul(g, re), hn::Mul(g, im), d, numbers);
    hn::Store(hn::Mul(g, hn::MulAdd(re, re, hn::Mul(im, im))), d, part);
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
HWY_EXPORT(slopes);
HWY_EXPORT(filter_all);
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
void find_slopes(const MeshGrid<Real>& grid, MeshAtoms<Real> atoms, Vec3* slope) {
  HWY_DYNAMIC_DISPATCH(slopes)(grid, atoms, slope);
}
template <>
double filter(std::span<const Real> factor, std::complex<Real>* z) {
  return HWY_DYNAMIC_DISPATCH(filter_all)(factor, z);
}

}  // namespace taut
#endif
