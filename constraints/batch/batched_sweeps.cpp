#include "constraints/batch/batched_sweeps.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "constraints/batch/batched_sweeps.cpp"
#include <hwy/foreach_target.h>

#include "constraints/batch/lanes-inl.hpp"

#ifndef TAUT_SWEEP_STEP
#define TAUT_SWEEP_STEP
namespace taut {
struct SweepStep {
  SweepLimits limits;
  double h, g_of_lambda, lambda_of_g;  // g = g_of_lambda·λ before the sweeps, λ = lambda_of_g·g after
  double *x, *v;
};
}  // namespace taut
#endif

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

struct SweepRows {
  double *x, *v;          // 3 × atoms
  double *r, *g, *error;  // r: 3 × bonds, directions of the corrections; others: bonds
  double* margin;         // of positions: how far a bond is from having turned by 90°
  double* inv_a_kk;       // of velocities, in the same place

  HWY_INLINE SweepRows(const AnyShape shape, Scratch scratch)
      : x(scratch.take(3 * shape.atoms())),
        v(scratch.take(3 * shape.atoms())),
        r(scratch.take(3 * shape.size())),
        g(scratch.take(shape.size())),
        error(scratch.take(shape.size())),
        margin(scratch.take(shape.size())),
        inv_a_kk(margin) {}
};

// g = g_of_lambda·λ, y += M⁻¹Jᵀg
HWY_INLINE void start_from_guess(const AnyShape shape, double g_of_lambda, const double* lambda,
                                 const SweepRows rows, double* y) {
  for (int k = 0; k < shape.size(); ++k) {
    const V g = g_of_lambda * load(lambda + k * kLanes);
    store(g, rows.g + k * kLanes);
    add_constraint_acceleration(shape, k, g, load3(rows.r + 3 * k * kLanes), y);
  }
}

HWY_INLINE void keep_multipliers(const AnyShape shape, double lambda_of_g, const SweepRows rows,
                                 double* lambda) {
  for (int k = 0; k < shape.size(); ++k) store(lambda_of_g * load(rows.g + k * kLanes), lambda + k * kLanes);
}

HWY_INLINE void correct_bond(const AnyShape shape, int k, V dg, const SweepRows rows, double* y) {
  store(load(rows.g + k * kLanes) + dg, rows.g + k * kLanes);
  add_constraint_acceleration(shape, k, dg, load3(rows.r + 3 * k * kLanes), y);
}

struct SweepOfPositions {
  // Makes one sweep. On return rows.error has the residuals before the corrections, and rows.margin is
  // positive for bonds that have not turned by 90°. Returns the lanes in which no bond has.
  HWY_INLINE M operator()(const AnyShape shape, double tolerance, const SweepRows rows, Worst& worst) const {
    M sound = all_lanes();
    for (int k = 0; k < shape.size(); ++k) {
      const LaneBond& bond = shape.bonds[k];
      const V3 r = difference(shape, k, rows.x);
      const V off = twice_sigma(bond, r), along = dot(r, load3(rows.r + 3 * k * kLanes));
      const V error = worst.include(bond, off);
      store(error, rows.error + k * kLanes);
      const auto wrong = error > tolerance;
      const V margin =
          hn::IfThenElse(wrong, hn::NegMulAdd(broadcast(1e-6), broadcast(bond.length2), along), broadcast(1));
      sound = hn::And(sound, margin > 0);
      store(margin, rows.margin + k * kLanes);
      const V dg = -0.5 * off / (bond.reduced_inv_mass * along);
      correct_bond(shape, k, hn::IfThenElseZero(wrong, dg), rows, rows.x);
    }
    return sound;
  }
  static constexpr Failure kNoConvergence = Failure::kNoConvergence;
};

struct SweepOfVelocities {
  double h;
  HWY_INLINE M operator()(const AnyShape shape, double tolerance, const SweepRows rows, Worst& worst) const {
    for (int k = 0; k < shape.size(); ++k) {
      const LaneBond& bond = shape.bonds[k];
      const V3 v = difference(shape, k, rows.v);
      const V rate = dot(load3(rows.r + 3 * k * kLanes), v);
      const V error = hn::Abs(rate) * (2 * h * bond.half_inv_length2);
      worst.include(error);
      store(error, rows.error + k * kLanes);
      const V dg = -(rate * load(rows.inv_a_kk + k * kLanes));
      correct_bond(shape, k, hn::IfThenElseZero(error > tolerance, dg), rows, rows.v);
    }
    return all_lanes();
  }
  static constexpr Failure kNoConvergence = Failure::kVelocitiesNoConvergence;
};

// Reports the first bond that has turned too far.
HWY_NOINLINE void name_turned(const Part& part, const double* margin, SolveStats& stats) {
  stats.failure = Failure::kTurned;
  stats.max_residual = 1;
  for (int k = part.batch.plan.solved - 1; k >= 0; --k)
    for (int l = kWidth - 1; l >= 0; --l)
      if (!(margin[k * kLanes + l] > 0))
        stats.worst_bond = part.batch.bond(part.group, k, part.first_lane + l);
}

// Sweeps until all bonds are within tolerance, or the requested number of times. `stats` is combined with
// this part's.
template <class Sweep>
HWY_INLINE void repeat(const Sweep& sweep, const AnyShape shape, const SweepLimits& limits, const Part& part,
                       const SweepRows rows, SolveStats& stats) {
  const bool fixed = limits.sweeps > 0;
  const int most = fixed ? limits.sweeps : limits.max_sweeps;
  for (int n = 1; n <= most; ++n) {
    Worst worst;
    const bool turned = !hn::AllTrue(D(), sweep(shape, fixed ? 0.0 : limits.tolerance, rows, worst));
    const bool held = !fixed && worst.within(limits.tolerance);
    if (!held && !turned && n < most) continue;
    SolveStats own{.iterations = n};
    if (turned)
      name_turned(part, rows.margin, own);
    else if (!held && !fixed)
      own.failure = Sweep::kNoConvergence;
    if (!turned && (!own.converged() || !worst.within(stats.max_residual)))
      record_largest(part, rows.error, own);
    stats.beside(own);
    return;
  }
}

void sweep_positions_of(SweepBatch& batch, const SweepStep& step, const Part& part, const Scratch& scratch,
                        SolveStats& stats) {
  const AnyShape shape(batch.lanes);
  const SweepRows rows(shape, scratch);
  double* lambda = batch.lambda.of(part.group) + part.first_lane;
  gather(part, shape.atoms(), step.x, rows.x);
  gather(part, shape.atoms(), step.v, rows.v);
  for (int k = 0; k < shape.size(); ++k)
    store3(difference(shape, k, rows.x) - step.h * difference(shape, k, rows.v), rows.r + 3 * k * kLanes);
  start_from_guess(shape, step.g_of_lambda, lambda, rows, rows.x);
  repeat(SweepOfPositions{}, shape, step.limits, part, rows, stats);
  for (int k = 0; k < shape.size(); ++k)
    add_constraint_acceleration(shape, k, 1 / step.h * load(rows.g + k * kLanes),
                                load3(rows.r + 3 * k * kLanes), rows.v);
  keep_multipliers(shape, step.lambda_of_g, rows, lambda);
  scatter(shape, part, rows.x, step.x);
  scatter(shape, part, rows.v, step.v);
}

void sweep_velocities_of(SweepBatch& batch, const SweepStep& step, const Part& part, const Scratch& scratch,
                         SolveStats& stats) {
  const AnyShape shape(batch.lanes);
  const SweepRows rows(shape, scratch);
  double* lambda = batch.lambda.of(part.group) + part.first_lane;
  gather(part, shape.atoms(), step.x, rows.x);
  gather(part, shape.atoms(), step.v, rows.v);
  for (int k = 0; k < shape.size(); ++k) {
    const V3 r = difference(shape, k, rows.x);
    store3(r, rows.r + 3 * k * kLanes);
    const V a_kk = shape.bonds[k].reduced_inv_mass * dot(r, r);
    store(1 / a_kk, rows.inv_a_kk + k * kLanes);
  }
  start_from_guess(shape, step.g_of_lambda, lambda, rows, rows.v);
  repeat(SweepOfVelocities{step.h}, shape, step.limits, part, rows, stats);
  keep_multipliers(shape, step.lambda_of_g, rows, lambda);
  scatter(shape, part, rows.v, step.v);
}

SolveStats sweep_positions(SweepBatch& batch, const SweepStep& step, int begin, int end,
                           const Scratch& scratch) {
  SolveStats stats;
  for_each_part(batch.lanes, begin, end, scratch, [&](auto, const Part& part, const Scratch& rows) HWY_ATTR {
    sweep_positions_of(batch, step, part, rows, stats);
  });
  return stats;
}

SolveStats sweep_velocities(SweepBatch& batch, const SweepStep& step, int begin, int end,
                            const Scratch& scratch) {
  SolveStats stats;
  for_each_part(batch.lanes, begin, end, scratch, [&](auto, const Part& part, const Scratch& rows) HWY_ATTR {
    sweep_velocities_of(batch, step, part, rows, stats);
  });
  return stats;
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(sweep_positions);
HWY_EXPORT(sweep_velocities);

Batched<Shake>::Batched(const System& sys, const Options& options, double h)
    : BatchedMethod(sys, options, h, find_clusters(sys)) {}

SolveStats Batched<Shake>::project_positions(const System&, double h, State& s) {
  const SweepStep step{.limits = options_,
                       .h = h,
                       .g_of_lambda = h * h,
                       .lambda_of_g = 1 / (h * h),
                       .x = s.x.data(),
                       .v = s.v.data()};
  return batches_.run(HWY_DYNAMIC_DISPATCH(sweep_positions), step).beside(leftover_.project_positions(h, s));
}

Batched<Rattle>::Batched(const System& sys, const Options& options, double h)
    : BatchedMethod(sys, options, h, find_clusters(sys)) {}

SolveStats Batched<Rattle>::project_positions(const System&, double h, State& s) {
  const SweepStep step{.limits = options_,
                       .h = h,
                       .g_of_lambda = options_.warm_start ? 0.5 * h * h : 0.0,
                       .lambda_of_g = 2 / (h * h),
                       .x = s.x.data(),
                       .v = s.v.data()};
  return batches_.run(HWY_DYNAMIC_DISPATCH(sweep_positions), step).beside(leftover_.project_positions(h, s));
}

SolveStats Batched<Rattle>::project_velocities(const System&, double h, State& s) {
  const SweepStep step{.limits = options_,
                       .h = h,
                       .g_of_lambda = options_.warm_start ? 0.5 * h : 0.0,
                       .lambda_of_g = 2 / h,
                       .x = s.x.data(),
                       .v = s.v.data()};
  return batches_.run(HWY_DYNAMIC_DISPATCH(sweep_velocities), step)
      .beside(leftover_.project_velocities(h, s));
}

}  // namespace taut
#endif
