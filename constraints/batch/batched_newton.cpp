#include "constraints/batch/batched_newton.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "constraints/batch/batched_newton.cpp"
#include <hwy/foreach_target.h>

#include "constraints/batch/velocities-inl.hpp"

#ifndef TAUT_NEWTON_STEP
#define TAUT_NEWTON_STEP
namespace taut {
struct NewtonStep {
  double h;
  Newton::Options options;
  bool factored;
  double *x, *v;
};
}  // namespace taut
#endif

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

struct NewtonRows {
  double *x, *v;  // 3 × atoms
  double *r, *g;  // r: 3 × bonds, g: bonds

  HWY_INLINE NewtonRows(const auto shape, Scratch& scratch)
      : x(scratch.take(3 * shape.atoms())),
        v(scratch.take(3 * shape.atoms())),
        r(scratch.take(3 * shape.size())),
        g(scratch.take(shape.size())) {}
};

// Whole clusters keep 1/d and L in the batch from step to step.
template <class Shape>
HWY_INLINE Equations newton_equations(const Shape shape, NewtonBatch& batch, const Part& part,
                                      Scratch& scratch) {
  Equations eq = equations(shape, scratch);
  if (part.batch.piece()) return eq;
  eq.A.inv_d = batch.factors.of(part.group) + part.first_lane;
  eq.A.l = eq.A.inv_d + shape.size() * kLanes;
  return eq;
}

// Computes r at the positions before the drift, x − hv.
template <class Shape>
HWY_INLINE void find_old_bonds(const Shape shape, double h, const NewtonRows rows) {
  for (int k = 0; k < shape.size(); ++k)
    store3(difference(shape, k, rows.x) - h * difference(shape, k, rows.v), rows.r + 3 * k * kLanes);
}

// b = −σ at x
template <class Shape>
HWY_INLINE Worst find_sigma(const Shape shape, const double* x, double* b) {
  Worst worst;
  for (int k = 0; k < shape.solved(); ++k) {
    const V3 r = difference(shape, k, x);
    const V off = twice_sigma(shape.bonds[k], r);
    worst.include(shape.bonds[k], off);
    store(-0.5 * off, b + k * kLanes);
  }
  return worst;
}

// x += M⁻¹J(x_old)ᵀb, g += b
template <class Shape>
HWY_INLINE void apply_change(const Shape shape, const double* change, const NewtonRows rows) {
  for (int k = 0; k < shape.size(); ++k) {
    const V b = load(change + k * kLanes);
    store(load(rows.g + k * kLanes) + b, rows.g + k * kLanes);
    add_constraint_acceleration(shape, k, b, load3(rows.r + 3 * k * kLanes), rows.x);
  }
}

template <class Shape>
struct NewtonKernel {
  static constexpr bool kOnceMostly = false;
  const Shape shape;
  const NewtonStep& step;
  const Part& part;
  double* lambda;
  Equations eq;
  NewtonRows rows;
  double* x;
  Worst worst;

  HWY_INLINE NewtonKernel(const Shape its_shape, NewtonBatch& batch, const NewtonStep& its_step,
                          const Part& its_part, Scratch& scratch)
      : shape(its_shape),
        step(its_step),
        part(its_part),
        lambda(batch.lambda.of(part.group) + part.first_lane),
        eq(newton_equations(shape, batch, part, scratch)),
        rows(shape, scratch),
        x(rows.x) {}

  HWY_INLINE SolveNext start(SolveStats& stats) {
    gather(part, shape.atoms(), step.x, rows.x);
    gather(part, shape.atoms(), step.v, rows.v);
    find_old_bonds(shape, step.h, rows);
    if (!step.factored && !factor_old_bonds(stats)) return SolveNext::kEnd;
    for (int k = 0; k < shape.size(); ++k) {
      const V g = 0.5 * step.h * step.h * load(lambda + k * kLanes);
      store(g, rows.g + k * kLanes);
      add_constraint_acceleration(shape, k, g, load3(rows.r + 3 * k * kLanes), rows.x);
    }
    return look(0, stats);
  }
  HWY_INLINE SolveNext look(int solves, SolveStats& stats) {
    worst = find_sigma(shape, rows.x, eq.b);
    if (worst.within(step.options.tolerance)) return SolveNext::kEnd;
    if (solves < step.options.max_iterations && worst.within(1e3)) return SolveNext::kSolve;
    stats.failure = Failure::kNoConvergence;
    return SolveNext::kEnd;
  }
  // In the first step no factors are kept yet. b is not known here and is set to 0.
  HWY_INLINE bool factor_old_bonds(SolveStats& stats) {
    for (int k = 0; k < shape.solved(); ++k) {
      const V3 r = load3(rows.r + 3 * k * kLanes);
      store(shape.bonds[k].reduced_inv_mass * dot(r, r), eq.A.d + k * kLanes);
      store(hn::Zero(D()), eq.b + k * kLanes);
    }
    return factor(shape, part, eq, rows.r, stats);
  }
  HWY_INLINE bool forward(int, SolveStats&) {
    substitute_forward(shape, part, eq);
    return true;
  }
  HWY_INLINE void back() { substitute_back(shape, eq.A.inv_d, eq.A.l, eq.b); }
  HWY_INLINE SolveNext apply(SolveNext, int solves, SolveStats& stats) {
    apply_change(shape, eq.b, rows);
    return look(solves, stats);
  }
  HWY_INLINE void end(SolveStats& stats) {
    for (int k = 0; k < shape.size(); ++k) {
      const V g = load(rows.g + k * kLanes);
      add_constraint_acceleration(shape, k, 1 / step.h * g, load3(rows.r + 3 * k * kLanes), rows.v);
      store(2 / (step.h * step.h) * g, lambda + k * kLanes);
    }
    scatter(shape, part, rows.x, step.x);
    scatter(shape, part, rows.v, step.v);
    if (worst.within(stats.max_residual)) return;  // a larger one is known
    find_residuals(part.batch, rows.x, eq.b);
    record_largest(part, eq.b, stats);
  }
};

template <class Shape>
struct NewtonVelocityKernel : VelocityKernel<Shape> {
  HWY_INLINE NewtonVelocityKernel(const Shape its_shape, NewtonBatch& batch, const VelocityStep& its_step,
                                  const Part& its_part, Scratch& scratch)
      : VelocityKernel<Shape>(its_shape, batch.lambda, its_step, its_part,
                              newton_equations(its_shape, batch, its_part, scratch), scratch) {}
};

SolveStats newton_positions(NewtonBatch& batch, const NewtonStep& step, const SolveCall& call, int begin,
                            int end, const Scratch& scratch) {
  return solve_groups<NewtonKernel>(batch, step, call, begin, end, scratch);
}

SolveStats newton_velocities(NewtonBatch& batch, const VelocityStep& step, const SolveCall& call, int begin,
                             int end, const Scratch& scratch) {
  return solve_groups<NewtonVelocityKernel>(batch, step, call, begin, end, scratch);
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(newton_positions);
HWY_EXPORT(newton_velocities);

Batched<Newton>::Batched(const System& sys, const Options& options, double h)
    : BatchedMethod(sys, options, h, find_clusters(sys, ClusterLimits::cutting())) {}

SolveStats Batched<Newton>::project_positions(const System&, double h, State& s) {
  const NewtonStep step{h, options_, factored_, s.x.data(), s.v.data()};
  return batches_.run(HWY_DYNAMIC_DISPATCH(newton_positions), step).beside(leftover_.project_positions(h, s));
}

SolveStats Batched<Newton>::project_velocities(const System&, double h, State& s) {
  const VelocityStep step{h, s.x.data(), s.v.data()};
  factored_ = true;
  return batches_.run(HWY_DYNAMIC_DISPATCH(newton_velocities), step)
      .beside(leftover_.project_velocities(h, s));
}

void Batched<Newton>::serialize(Archive& archive) {
  BatchedMethod::serialize(archive);
  archive(factored_);
}

}  // namespace taut
#endif
