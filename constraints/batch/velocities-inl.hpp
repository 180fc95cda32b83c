// RATTLE's projection of velocities by a direct solve: A g = −J v, v += M⁻¹Jᵀg. Compiled once for each SIMD
// target.
#if defined(TAUT_VELOCITIES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_VELOCITIES_INL_H
#undef TAUT_VELOCITIES_INL_H
#else
#define TAUT_VELOCITIES_INL_H
#endif

#include "constraints/batch/triangles-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

template <class Shape>
struct VelocityKernel {
  static constexpr bool kOnceMostly = true;
  const Shape shape;
  const VelocityStep& step;
  const Part& part;
  double* lambda;
  Equations eq;
  double *x_rows, *v, *r;
  static constexpr const double* x = nullptr;  // no positions change

  HWY_INLINE VelocityKernel(const Shape its_shape, LaneRows& multipliers, const VelocityStep& its_step,
                            const Part& its_part, const Equations& equations, Scratch& scratch)
      : shape(its_shape),
        step(its_step),
        part(its_part),
        lambda(multipliers.of(part.group) + part.first_lane),
        eq(equations),
        x_rows(scratch.take(3 * shape.atoms())),
        v(scratch.take(3 * shape.atoms())),
        r(scratch.take(3 * shape.size())) {}

  HWY_INLINE SolveNext start(SolveStats&) {
    gather(part, shape.atoms(), step.x, x_rows);
    gather(part, shape.atoms(), step.v, v);
    for (int k = 0; k < shape.solved(); ++k) {
      const V3 r_k = difference(shape, k, x_rows);
      store3(r_k, r + 3 * k * kLanes);
      store(shape.bonds[k].reduced_inv_mass * dot(r_k, r_k), eq.A.d + k * kLanes);
      store(-dot(r_k, difference(shape, k, v)), eq.b + k * kLanes);
    }
    return SolveNext::kLastSolve;
  }
  HWY_INLINE bool forward(int, SolveStats& stats) { return factor(shape, part, eq, r, stats); }
  HWY_INLINE void back() { substitute_back(shape, eq.A.inv_d, eq.A.l, eq.b); }
  HWY_INLINE SolveNext apply(SolveNext, int, SolveStats&) {
    for (int k = 0; k < shape.solved(); ++k) {
      const V g = load(eq.b + k * kLanes);
      store(2 / step.h * g, lambda + k * kLanes);
      add_constraint_acceleration(shape, k, g, load3(r + 3 * k * kLanes), v);
    }
    return SolveNext::kEnd;
  }
  HWY_INLINE void end(SolveStats&) { scatter(shape, part, v, step.v); }
};

// The same for triangles.
HWY_INLINE bool solve_velocities(const LaneBatch& lanes, LaneRows& multipliers, const VelocityStep& step,
                                 const Part& part, SolveStats& stats) {
  HWY_ALIGN double copies[2][9 * kWidth];
  const Nines nines(part);
  const double* x = nines.open(step.x, copies[0]);
  double* v = nines.open(step.v, copies[1]);
  const Sides r = sides(rows_of(load_nine(x))), w = sides(rows_of(load_nine(v)));
  const TriangleMatrix A(lanes, r, r);
  if (!hn::AllTrue(D(), A.regular(lanes))) return false;
  const Three g = A.solve({-dot(r.ab, w.ab), -dot(r.ac, w.ac), -dot(r.bc(), w.bc())});
  double* lambda = multipliers.of(part.group) + part.first_lane;
  for (int k = 0; k < 3; ++k) store(2 / step.h * g.k[k], lambda + k * kLanes);
  const Nine change = numbers_of(Forces(g, r).rows(InverseMasses(lanes)));
  for (int k = 0; k < 9; ++k) store_any(load_any(v + k * kWidth) + change.n[k], v + k * kWidth);
  nines.close(v, step.v);
  stats.iterations = 1;
  return true;
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
