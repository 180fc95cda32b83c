#include "constraints/batched_newton.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "constraints/batched_newton.cpp"
#include <hwy/foreach_target.h>

#include "constraints/lanes-inl.hpp"

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

// Scratch of one part; 1/d and L live with the batch.
struct NewtonRows {
  double *x, *v;          // of the atoms
  double *r, *b, *g, *d;  // of the bonds
  double *inv_d, *l;
};

HWY_INLINE NewtonRows newton_rows(NewtonBatch& batch, const Part& part, double* scratch) {
  const int atoms = 3 * batch.lanes.atoms * kWidth, bonds = batch.plan.size() * kWidth;
  double *r = scratch + 2 * atoms, *b = r + 3 * bonds;
  double* inv_d = batch.factors.of(part.group) + part.first_lane * (batch.plan.size() + batch.plan.entries());
  return {scratch, scratch + atoms, r, b, b + bonds, b + 2 * bonds, inv_d, inv_d + bonds};
}

HWY_INLINE bool factor(const NewtonBatch& batch, const Part& part, const NewtonRows rows, SolveStats& stats) {
  couple(batch.plan, rows.r, rows.r, rows.l);
  const Matrix A{batch.plan, rows.d, rows.inv_d, rows.l, nullptr};
  return regular(part, eliminate(A, batch.lanes.bonds.data(), rows.b), rows.d, stats);
}

// r of the positions before the drift, x − hv; and A's diagonal.
HWY_INLINE void find_old_bonds(const NewtonBatch& batch, double h, const NewtonRows rows) {
  const int n = batch.plan.size();
  const LaneBond* bonds = batch.lanes.bonds.data();
  for (int k = 0; k < n; ++k) {
    const int i = bonds[k].i * kWidth, j = bonds[k].j * kWidth;
    const V3 r =
        neg_mul_add(all(h), load3(rows.v + j) - load3(rows.v + i), load3(rows.x + j) - load3(rows.x + i));
    store3(r, rows.r + 3 * k * kWidth);
    store(hn::Mul(all(bonds[k].reduced_inv_mass), dot(r, r)), rows.d + k * kWidth);
  }
}

// b = −σ at x
HWY_INLINE Worst find_sigma(const NewtonBatch& batch, const NewtonRows rows) {
  const int n = batch.plan.size();
  const LaneBond* bonds = batch.lanes.bonds.data();
  Worst worst;
  for (int k = 0; k < n; ++k) {
    const V3 r = load3(rows.x + bonds[k].j * kWidth) - load3(rows.x + bonds[k].i * kWidth);
    const V offset = hn::Sub(dot(r, r), all(bonds[k].length2));
    worst.see(hn::Mul(hn::Abs(offset), all(bonds[k].half_inv_length2)));
    store(hn::Mul(all(-0.5), offset), rows.b + k * kWidth);
  }
  return worst;
}

// x += M⁻¹J(x_old)ᵀb, g += b
HWY_INLINE void correct(const NewtonBatch& batch, const NewtonRows rows) {
  const int n = batch.plan.size();
  const LaneBond* bonds = batch.lanes.bonds.data();
  for (int k = 0; k < n; ++k) {
    const V b = load(rows.b + k * kWidth);
    store(hn::Add(load(rows.g + k * kWidth), b), rows.g + k * kWidth);
    move(bonds[k], b, load3(rows.r + 3 * k * kWidth), rows.x);
  }
}

void newton_positions_of(NewtonBatch& batch, const NewtonStep& step, const Part& part, double* scratch,
                         SolveStats& stats) {
  const NewtonRows rows = newton_rows(batch, part, scratch);
  const int n = batch.plan.size();
  const LaneBond* bonds = batch.lanes.bonds.data();
  double* lambda = batch.lambda.of(part.group) + part.first_lane;
  gather(part, step.x, rows.x);
  gather(part, step.v, rows.v);
  find_old_bonds(batch, step.h, rows);
  if (!step.factored && !factor(batch, part, rows, stats)) return;

  for (int k = 0; k < n; ++k) {
    const V g = hn::Mul(all(0.5 * step.h * step.h), load(lambda + k * kLanes));
    store(g, rows.g + k * kWidth);
    move(bonds[k], g, load3(rows.r + 3 * k * kWidth), rows.x);
  }
  for (int iteration = 0;; ++iteration) {
    const Worst worst = find_sigma(batch, rows);
    stats.iterations = HWY_MAX(stats.iterations, iteration);
    const bool held = worst.within(step.options.tolerance);
    if (held || iteration == step.options.max_iterations || !worst.within(1e3)) {
      if (!worst.within(stats.max_residual)) {
        find_residuals(batch.lanes, rows.x, rows.b);
        enter(part, rows.b, stats);
      }
      if (!held) stats.failure = "no convergence";
      break;
    }
    substitute_forward(batch.plan, rows.l, rows.b);
    substitute_back(batch.plan, rows.inv_d, rows.l, rows.b);
    correct(batch, rows);
  }
  for (int k = 0; k < n; ++k) {
    const V g = load(rows.g + k * kWidth);
    move(bonds[k], hn::Mul(all(1 / step.h), g), load3(rows.r + 3 * k * kWidth), rows.v);
    store(hn::Mul(all(2 / (step.h * step.h)), g), lambda + k * kLanes);
  }
  scatter(part, rows.x, step.x);
  scatter(part, rows.v, step.v);
}

void newton_velocities_of(NewtonBatch& batch, const NewtonStep& step, const Part& part, double* scratch,
                          SolveStats& stats) {
  const NewtonRows rows = newton_rows(batch, part, scratch);
  const int n = batch.plan.size();
  const LaneBond* bonds = batch.lanes.bonds.data();
  double* lambda = batch.lambda.of(part.group) + part.first_lane;
  gather(part, step.x, rows.x);
  gather(part, step.v, rows.v);
  for (int k = 0; k < n; ++k) {
    const int i = bonds[k].i * kWidth, j = bonds[k].j * kWidth;
    const V3 r = load3(rows.x + j) - load3(rows.x + i);
    store3(r, rows.r + 3 * k * kWidth);
    store(hn::Mul(all(bonds[k].reduced_inv_mass), dot(r, r)), rows.d + k * kWidth);
    store(hn::Neg(dot(r, load3(rows.v + j) - load3(rows.v + i))), rows.b + k * kWidth);
  }
  if (!factor(batch, part, rows, stats)) return;
  substitute_back(batch.plan, rows.inv_d, rows.l, rows.b);
  for (int k = 0; k < n; ++k) {
    const V g = load(rows.b + k * kWidth);
    store(hn::Mul(all(2 / step.h), g), lambda + k * kLanes);
    move(bonds[k], g, load3(rows.r + 3 * k * kWidth), rows.v);
  }
  scatter(part, rows.v, step.v);
}

SolveStats newton_positions(NewtonBatch& batch, const NewtonStep& step, int begin, int end, double* scratch) {
  SolveStats stats;
  for_each_part(batch.lanes, begin, end,
                [&](const Part& part) HWY_ATTR { newton_positions_of(batch, step, part, scratch, stats); });
  return stats;
}

SolveStats newton_velocities(NewtonBatch& batch, const NewtonStep& step, int begin, int end,
                             double* scratch) {
  SolveStats stats{.iterations = 1};
  for_each_part(batch.lanes, begin, end,
                [&](const Part& part) HWY_ATTR { newton_velocities_of(batch, step, part, scratch, stats); });
  return stats;
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(newton_positions);
HWY_EXPORT(newton_velocities);

Batched<Newton>::Batched(const System& sys, const Options& options, double h)
    : Batched(sys, options, h, find_clusters(sys, kMostBondsInLanes)) {}

Batched<Newton>::Batched(const System& sys, const Options& options, double h, const BondClusters& clusters)
    : options_(options),
      leftover_(sys, clusters.rest, options, h),
      lambda_(Eigen::VectorXd::Zero(sys.bond_count())) {
  for (const ClusterBatch& batch : clusters.batches) {
    Elimination plan(batch.shape);
    LaneBatch lanes(batch, plan.order);
    LaneRows lambda(lanes.groups, plan.size()), factors(lanes.groups, plan.size() + plan.entries());
    runner_.add(lanes, scratch_rows(lanes, plan));
    batches_.push_back({std::move(lanes), std::move(plan), std::move(lambda), std::move(factors)});
  }
}

SolveStats Batched<Newton>::project_positions(const System&, double h, State& s) {
  const NewtonStep step{h, options_, factored_, s.x.data(), s.v.data()};
  SolveStats stats = runner_.run([&](int b, int begin, int end, double* scratch) {
    return HWY_DYNAMIC_DISPATCH(newton_positions)(batches_[b], step, begin, end, scratch);
  });
  LaneRunner::merge(stats, leftover_.project_positions(h, s));
  return stats;
}

SolveStats Batched<Newton>::project_velocities(const System&, double h, State& s) {
  const NewtonStep step{h, options_, factored_, s.x.data(), s.v.data()};
  SolveStats stats = runner_.run([&](int b, int begin, int end, double* scratch) {
    return HWY_DYNAMIC_DISPATCH(newton_velocities)(batches_[b], step, begin, end, scratch);
  });
  factored_ = true;
  LaneRunner::merge(stats, leftover_.project_velocities(h, s));
  return stats;
}

const Eigen::VectorXd& Batched<Newton>::lambda() const {
  for (const NewtonBatch& batch : batches_) rows_to_bonds(batch.lanes, batch.lambda, lambda_);
  leftover_.write_lambda(lambda_);
  return lambda_;
}

}  // namespace taut
#endif
