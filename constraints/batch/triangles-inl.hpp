// Triangles of bonds, one cluster per lane, that stay in registers from load to store. Compiled once for each
// SIMD target.
#if defined(TAUT_TRIANGLES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_TRIANGLES_INL_H
#undef TAUT_TRIANGLES_INL_H
#else
#define TAUT_TRIANGLES_INL_H
#endif

#include "constraints/batch/nines-inl.hpp"
#include "constraints/batch/solving-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

// One value for each bond of a triangle: a–b, a–c, b–c.
struct Three {
  V k[3];
};
HWY_INLINE Three load_three(const double* rows) {
  return {load(rows), load(rows + kLanes), load(rows + 2 * kLanes)};
}
HWY_INLINE void store_three(const Three& t, double* rows) {
  for (int k = 0; k < 3; ++k) store(t.k[k], rows + k * kLanes);
}
HWY_INLINE Three operator+(const Three& a, const Three& b) {
  return {a.k[0] + b.k[0], a.k[1] + b.k[1], a.k[2] + b.k[2]};
}

// Differences between the atoms of the first two bonds; the third is their difference.
struct Sides {
  V3 ab, ac;

  HWY_INLINE V3 bc() const { return ac - ab; }
};
HWY_INLINE Sides sides(const Nine& rows) {
  return {rows.atom(1) - rows.atom(0), rows.atom(2) - rows.atom(0)};
}
HWY_INLINE Sides operator+(const Sides& a, const Sides& b) {
  return {a.ab + b.ab, a.ac + b.ac};
}
HWY_INLINE Sides operator-(const Sides& a, const Sides& b) {
  return {a.ab - b.ab, a.ac - b.ac};
}
HWY_INLINE Sides operator*(double s, const Sides& a) {
  return {s * a.ab, s * a.ac};
}

struct InverseMasses {
  V a, b, c;

  HWY_INLINE explicit InverseMasses(const LaneBatch& batch)
      : a(broadcast(batch.inv_mass[0])), b(broadcast(batch.inv_mass[1])), c(broadcast(batch.inv_mass[2])) {}
};

// Jᵀλ
struct Forces {
  V3 a, b, c;  // forces on b and c, and minus the force on a

  HWY_INLINE Forces(const Three& lambda, const Sides& r) {
    const V3 ab = lambda.k[0] * r.ab, ac = lambda.k[1] * r.ac, bc = lambda.k[2] * r.bc();
    a = ab + ac;
    b = ab - bc;
    c = ac + bc;
  }
  // Differences of M⁻¹Jᵀλ between atoms.
  HWY_INLINE Sides accelerations(const InverseMasses& m) const {
    const V3 of_b = m.b * b, of_c = m.c * c, of_a = m.a * a;
    return {of_a + of_b, of_a + of_c};
  }
  HWY_INLINE Nine rows(const InverseMasses& m) const {  // M⁻¹Jᵀλ
    const V3 of_a = -m.a * a, of_b = m.b * b, of_c = m.c * c;
    return {of_a.x, of_a.y, of_a.z, of_b.x, of_b.y, of_b.z, of_c.x, of_c.y, of_c.z};
  }
  HWY_INLINE Nine rows() const { return {-a.x, -a.y, -a.z, b.x, b.y, b.z, c.x, c.y, c.z}; }
};

// |r|² − d²
HWY_INLINE Three twice_sigma(const LaneBatch& batch, const Sides& r) {
  return {twice_sigma(batch.bonds[0], r.ab), twice_sigma(batch.bonds[1], r.ac),
          twice_sigma(batch.bonds[2], r.bc())};
}
HWY_INLINE Worst worst_of(const LaneBatch& batch, const Three& twice_sigma) {
  Worst worst;
  for (int k = 0; k < 3; ++k) worst.include(batch.bonds[k], twice_sigma.k[k]);
  return worst;
}

// The matrix A' = J(r_next) M⁻¹ J(r)ᵀ, which is A if r_next = r. It is solved by Cramer's rule, which has one
// division; elimination has three that depend on each other.
struct TriangleMatrix {
  Three along;  // r_next·r
  V a[3][3], minor[3][3];
  V det;

  HWY_INLINE TriangleMatrix(const LaneBatch& batch, const Sides& r_next, const Sides& r) {
    const InverseMasses m(batch);
    // The products of the third bond follow from those of the first two.
    const V bb = dot(r_next.ab, r.ab), bc = dot(r_next.ab, r.ac), cb = dot(r_next.ac, r.ab),
            cc = dot(r_next.ac, r.ac), b3 = bb - bc, c3 = cc - cb;
    along = {bb, cc, b3 + c3};
    for (int k = 0; k < 3; ++k) a[k][k] = batch.bonds[k].reduced_inv_mass * along.k[k];
    a[0][1] = m.a * bc;
    a[1][0] = m.a * cb;
    a[0][2] = m.b * b3;
    a[2][0] = m.b * (bb - cb);
    a[1][2] = m.c * c3;
    a[2][1] = m.c * (cc - bc);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const int p = (i + 1) % 3, q = (i + 2) % 3, s = (j + 1) % 3, t = (j + 2) % 3;
        minor[i][j] = hn::MulSub(a[p][s], a[q][t], a[p][t] * a[q][s]);
      }
    det = a[0][0] * minor[0][0] + a[0][1] * minor[0][1] + a[0][2] * minor[0][2];
  }

  // Returns the lanes in which every pivot of the elimination exceeds the threshold for dependent bonds.
  HWY_INLINE M regular(const LaneBatch& batch) const {
    const auto least = [&](int k) HWY_ATTR { return broadcast(batch.bonds[k].least_pivot); };
    return hn::And(hn::And(a[0][0] > least(0), minor[2][2] > least(1) * a[0][0]),
                   det > least(2) * minor[2][2]);
  }
  HWY_INLINE Three solve(const Three& b) const {
    Three z;
    for (int k = 0; k < 3; ++k)
      z.k[k] = 1 / det * (minor[0][k] * b.k[0] + minor[1][k] * b.k[1] + minor[2][k] * b.k[2]);
    return z;
  }
};

// Records the largest residual of a part and its bond in the stats.
inline HWY_NOINLINE void enter_residuals(const Part& part, const double* array, SolveStats& stats) {
  HWY_ALIGN double x[9 * kLanes], relative[3 * kLanes];
  gather(part, 3, array, x);
  find_residuals(part.batch, x, relative);
  record_largest(part, relative, stats);
}

// The groups of a call, and the thread's scratch.
struct Groups {
  int begin, end;
  const Scratch& scratch;
};

// Calls attempt(part, stats) for all parts of the groups begin … end − 1. If an attempt fails, which changes
// nothing, the part is solved again as a general cluster, and Kernel reports what is wrong with it.
template <template <class> class Kernel, class Batch, class Step, class Attempt>
HWY_INLINE SolveStats solve_triangles(Batch& batch, const Step& step, const Groups& groups,
                                      const Attempt& attempt) {
  SolveStats all;
  for (int g = groups.begin; g < groups.end; ++g)
    for (int l = 0; l < batch.lanes.filled(g); l += kWidth) {
      const Part part{batch.lanes, g, l};
      SolveStats own{.max_residual = all.max_residual};
      if (!attempt(part, own))
        solve_part<Kernel>(AnyShape(batch.lanes), batch, step, part, groups.scratch, own);
      all.beside(own);
    }
  return all;
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
