// What the kernels share, compiled once for each kind of machine (Highway's foreach_target).
#if defined(TAUT_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_LANES_INL_H
#undef TAUT_LANES_INL_H
#else
#define TAUT_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <utility>

#include "constraints/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, kLanes>;
using V = hn::Vec<D>;
inline constexpr int kWidth = static_cast<int>(hn::MaxLanes(D()));  // of a row in scratch

HWY_INLINE V load(const double* row) {
  return hn::Load(D(), row);
}
HWY_INLINE void store(V value, double* row) {
  hn::Store(value, D(), row);
}
HWY_INLINE V all(double value) {
  return hn::Set(D(), value);
}

// Three rows in succession: a vector of each cluster.
struct V3 {
  V x, y, z;
};
HWY_INLINE V3 load3(const double* rows) {
  return {load(rows), load(rows + kWidth), load(rows + 2 * kWidth)};
}
HWY_INLINE void store3(const V3& a, double* rows) {
  store(a.x, rows);
  store(a.y, rows + kWidth);
  store(a.z, rows + 2 * kWidth);
}
HWY_INLINE V3 operator+(const V3& a, const V3& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE V3 operator-(const V3& a, const V3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE V3 operator*(V s, const V3& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
// s·a + b
HWY_INLINE V3 mul_add(V s, const V3& a, const V3& b) {
  return {hn::MulAdd(s, a.x, b.x), hn::MulAdd(s, a.y, b.y), hn::MulAdd(s, a.z, b.z)};
}
// b − s·a
HWY_INLINE V3 neg_mul_add(V s, const V3& a, const V3& b) {
  return {hn::NegMulAdd(s, a.x, b.x), hn::NegMulAdd(s, a.y, b.y), hn::NegMulAdd(s, a.z, b.z)};
}
HWY_INLINE V dot(const V3& a, const V3& b) {
  return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, hn::Mul(a.x, b.x)));
}

// Rows n and columns n change places. Each of log₂(width) rounds takes the lowest bit of the column for one
// bit of the row.
template <int kBit, int kRow>
HWY_INLINE void exchange([[maybe_unused]] V* t) {
#if HWY_TARGET != HWY_SCALAR
  if constexpr ((kRow & kBit) == 0) {
    const V even = hn::ConcatEven(D(), t[kRow | kBit], t[kRow]),
            odd = hn::ConcatOdd(D(), t[kRow | kBit], t[kRow]);
    t[kRow] = even;
    t[kRow | kBit] = odd;
  }
#endif
}
template <int... kRows>
HWY_INLINE void transpose(V* t, std::integer_sequence<int, kRows...>) {
  if constexpr (kWidth > 1) (exchange<1, kRows>(t), ...);
  if constexpr (kWidth > 2) (exchange<2, kRows>(t), ...);
  if constexpr (kWidth > 4) (exchange<4, kRows>(t), ...);
}
HWY_INLINE void transpose(V* t) {
  transpose(t, std::make_integer_sequence<int, kWidth>());
}

// Lanes of a group that are worked on at once, from the first of them.
struct Part {
  const LaneBatch& batch;
  int group, first_lane;

  const int* places() const { return batch.places(group) + first_lane; }
};

// work(part) for every part of the groups begin … end − 1
template <class Work>
HWY_INLINE void for_each_part(const LaneBatch& batch, int begin, int end, const Work& work) {
  for (int g = begin; g < end; ++g)
    for (int l = 0; l < batch.filled(g); l += kWidth) work(Part{batch, g, l});
}

// How rows and a 3 × n array correspond: blocks of columns that are transposed, the last of which may overlap
// the one before, and columns that are copied one by one where that is less work (or all that can be done).
struct Columns {
  int blocks_end, copied_from;

  explicit Columns(const LaneBatch& batch) {
    const int width = 3 * batch.atoms, over = width % kWidth;
    const bool copy = over <= 2 || width < kWidth;
    blocks_end = !batch.contiguous ? 0 : copy ? width - over : width;
    copied_from = blocks_end;
  }
};

// One number of each cluster, column c of its atoms.
HWY_INLINE const int* places_of_column(const LaneBatch& batch, const int* place, int c, int& offset) {
  offset = batch.contiguous ? c : c % 3;
  return batch.contiguous ? place : place + c / 3 * kLanes;
}

// rows ← the clusters' atoms in a 3 × n array
HWY_INLINE void gather(const Part& part, const double* HWY_RESTRICT array, double* HWY_RESTRICT rows) {
  const LaneBatch& batch = part.batch;
  const int width = 3 * batch.atoms;
  const int* place = part.places();
  const Columns columns(batch);
  for (int from = 0; from < columns.blocks_end; from += kWidth) {
    const int column = HWY_MIN(from, width - kWidth);
    V t[kWidth];
    for (int l = 0; l < kWidth; ++l) t[l] = hn::LoadU(D(), array + place[l] + column);
    transpose(t);
    for (int c = 0; c < kWidth; ++c) store(t[c], rows + (column + c) * kWidth);
  }
  for (int c = columns.copied_from, offset = 0; c < width; ++c) {
    const int* from = places_of_column(batch, place, c, offset);
    for (int l = 0; l < kWidth; ++l) rows[c * kWidth + l] = array[from[l] + offset];
  }
}

// ... and back
HWY_INLINE void scatter(const Part& part, const double* HWY_RESTRICT rows, double* HWY_RESTRICT array) {
  const LaneBatch& batch = part.batch;
  const int width = 3 * batch.atoms;
  const int* place = part.places();
  const Columns columns(batch);
  for (int from = 0; from < columns.blocks_end; from += kWidth) {
    const int column = HWY_MIN(from, width - kWidth);
    V t[kWidth];
    for (int c = 0; c < kWidth; ++c) t[c] = load(rows + (column + c) * kWidth);
    transpose(t);
    for (int l = 0; l < kWidth; ++l) hn::StoreU(t[l], D(), array + place[l] + column);
  }
  for (int c = columns.copied_from, offset = 0; c < width; ++c) {
    const int* to = places_of_column(batch, place, c, offset);
    for (int l = 0; l < kWidth; ++l) array[to[l] + offset] = rows[c * kWidth + l];
  }
}

// f += Jᵀλ for one bond
HWY_INLINE void pull(const LaneBond& bond, V lambda, const V3& r, double* f) {
  const V3 force = lambda * r;
  double *f_i = f + bond.i * kWidth, *f_j = f + bond.j * kWidth;
  store3(load3(f_i) - force, f_i);
  store3(load3(f_j) + force, f_j);
}

// y += M⁻¹Jᵀλ for one bond
HWY_INLINE void move(const LaneBond& bond, V lambda, const V3& r, double* y) {
  const V3 force = lambda * r;
  double *y_i = y + bond.i * kWidth, *y_j = y + bond.j * kWidth;
  store3(neg_mul_add(all(bond.inv_mass_i), force, load3(y_i)), y_i);
  store3(mul_add(all(bond.inv_mass_j), force, load3(y_j)), y_j);
}

// The matrix of a group in scratch, and the solution of systems with it.
struct Matrix {
  const Elimination& plan;
  double *d, *inv_d;  // rows of the diagonal, and of its inverse after elimination
  double *l, *u;      // rows of the entries below the diagonal and, unless symmetric (then null), above
};

// ±(r_row·r_k)/m, 0 where there will be fill: A's entries below the diagonal. With `left` and `right` of
// different times: A' below it; changed about: above.
HWY_INLINE void couple(const Elimination& plan, const double* left, const double* right, double* entries) {
  const int n = plan.size(), *start = plan.column_start.data(), *row = plan.row.data();
  const double* signed_inv_mass = plan.signed_inv_mass.data();
  for (int k = 0; k < n; ++k) {
    const V3 r_k = load3(right + 3 * k * kWidth);
    for (int p = start[k]; p < start[k + 1]; ++p)
      store(hn::Mul(all(signed_inv_mass[p]), dot(load3(left + 3 * row[p] * kWidth), r_k)),
            entries + p * kWidth);
  }
}

// L D Lᵀ in place (l holds A's entries before); b goes through the forward substitution on the way.
// Returns the pivots' smallest margin over what a dependent bond leaves.
HWY_INLINE V eliminate(const Matrix A, const LaneBond* bonds, double* b) {
  const int n = A.plan.size(), *update = A.plan.update.data();
  const int *start = A.plan.column_start.data(), *row = A.plan.row.data();
  V margin = all(1e300);
  for (int k = 0; k < n; ++k) {
    const V d = load(A.d + k * kWidth), inv = hn::Div(all(1), d), b_k = load(b + k * kWidth);
    margin = hn::Min(margin, hn::Sub(d, all(bonds[k].least_pivot)));
    store(inv, A.inv_d + k * kWidth);
    for (int p = start[k]; p < start[k + 1]; ++p) {
      const V c = load(A.l + p * kWidth), l = hn::Mul(c, inv);
      double *d_p = A.d + row[p] * kWidth, *b_p = b + row[p] * kWidth;
      for (int q = p + 1; q < start[k + 1]; ++q) {
        double* c_qp = A.l + *update++ * kWidth;
        store(hn::NegMulAdd(l, load(A.l + q * kWidth), load(c_qp)), c_qp);
      }
      store(l, A.l + p * kWidth);
      store(hn::NegMulAdd(l, c, load(d_p)), d_p);
      store(hn::NegMulAdd(l, b_k, load(b_p)), b_p);
    }
  }
  return margin;
}

// L D U in place, l and u with A's entries below and above the diagonal before; else as above. u ends as a
// unit upper triangle.
HWY_INLINE V eliminate_turned(const Matrix A, const LaneBond* bonds, double* b) {
  const int n = A.plan.size(), *update = A.plan.update.data();
  const int *start = A.plan.column_start.data(), *row = A.plan.row.data();
  V margin = all(1e300);
  for (int k = 0; k < n; ++k) {
    const V d = load(A.d + k * kWidth), inv = hn::Div(all(1), d), b_k = load(b + k * kWidth);
    margin = hn::Min(margin, hn::Sub(d, all(bonds[k].least_pivot)));
    store(inv, A.inv_d + k * kWidth);
    for (int p = start[k]; p < start[k + 1]; ++p) {
      const V l = hn::Mul(load(A.l + p * kWidth), inv), u = load(A.u + p * kWidth), u_unit = hn::Mul(u, inv);
      double *d_p = A.d + row[p] * kWidth, *b_p = b + row[p] * kWidth;
      for (int q = p + 1; q < start[k + 1]; ++q) {
        double *below = A.l + *update * kWidth, *above = A.u + *update * kWidth;
        ++update;
        store(hn::NegMulAdd(load(A.l + q * kWidth), u_unit, load(below)), below);
        store(hn::NegMulAdd(l, load(A.u + q * kWidth), load(above)), above);
      }
      store(l, A.l + p * kWidth);
      store(u_unit, A.u + p * kWidth);
      store(hn::NegMulAdd(l, u, load(d_p)), d_p);
      store(hn::NegMulAdd(l, b_k, load(b_p)), b_p);
    }
  }
  return margin;
}

// Names a bond whose pivot vanished. False if there is one.
HWY_INLINE bool regular(const Part& part, V margin, const double* d, SolveStats& stats) {
  const D tag;
  if (hn::AllTrue(tag, hn::Gt(margin, hn::Zero(tag)))) return true;
  stats.failure = "A is singular";
  for (int k = part.batch.bond_count() - 1; k >= 0; --k)
    for (int l = kWidth - 1; l >= 0; --l)
      if (!(d[k * kWidth + l] > part.batch.bonds[k].least_pivot))
        stats.worst_bond = part.batch.bond(part.group, k, part.first_lane + l);
  return false;
}

// b ← L⁻¹b
HWY_INLINE void substitute_forward(const Elimination& plan, const double* l, double* b) {
  const int n = plan.size(), *start = plan.column_start.data(), *row = plan.row.data();
  for (int k = 0; k < n; ++k) {
    const V b_k = load(b + k * kWidth);
    for (int p = start[k]; p < start[k + 1]; ++p) {
      double* b_p = b + row[p] * kWidth;
      store(hn::NegMulAdd(load(l + p * kWidth), b_k, load(b_p)), b_p);
    }
  }
}

// b ← U⁻¹D⁻¹b, u unit upper triangular by rows
HWY_INLINE void substitute_back(const Elimination& plan, const double* inv_d, const double* u, double* b) {
  const int *start = plan.column_start.data(), *row = plan.row.data();
  for (int k = plan.size() - 1; k >= 0; --k) {
    V z = hn::Mul(load(b + k * kWidth), load(inv_d + k * kWidth));
    for (int p = start[k]; p < start[k + 1]; ++p)
      z = hn::NegMulAdd(load(u + p * kWidth), load(b + row[p] * kWidth), z);
    store(z, b + k * kWidth);
  }
}

// The largest |σ|/d² of a part, and whether all of them are numbers.
struct Worst {
  V largest, sum;

  HWY_INLINE Worst() : largest(hn::Zero(D())), sum(hn::Zero(D())) {}
  HWY_INLINE void see(V relative) {
    largest = hn::Max(largest, relative);
    sum = hn::Add(sum, relative);
  }
  // All of them numbers and at most so large.
  HWY_INLINE bool within(double limit) const {
    return hn::AllTrue(D(), hn::And(hn::Le(largest, all(limit)), hn::Eq(sum, sum)));
  }
};

// |σ|/d² of every bond, from positions
inline HWY_NOINLINE void find_residuals(const LaneBatch& batch, const double* x, double* relative) {
  for (int k = 0; k < batch.bond_count(); ++k) {
    const LaneBond& bond = batch.bonds[k];
    const V3 r = load3(x + bond.j * kWidth) - load3(x + bond.i * kWidth);
    const V offset = hn::Sub(dot(r, r), all(bond.length2));
    store(hn::Mul(hn::Abs(offset), all(bond.half_inv_length2)), relative + k * kWidth);
  }
}

// The largest of these residuals, and where, entered into the stats if it is larger. A NaN is largest.
inline HWY_NOINLINE void enter(const Part& part, const double* relative, SolveStats& stats) {
  for (int n = 0; n < part.batch.bond_count() * kWidth; ++n) {
    if (relative[n] <= stats.max_residual || stats.max_residual != stats.max_residual) continue;
    stats.max_residual = relative[n];
    stats.worst_bond = part.batch.bond(part.group, n / kWidth, part.first_lane + n % kWidth);
  }
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
