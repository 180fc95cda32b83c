#include "constraints/lanes/batched_newton.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "constraints/lanes/batched_newton.cpp"
#include <hwy/foreach_target.h>

#include "constraints/lanes/elimination-inl.hpp"

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
  double *x, *v;      // of the atoms
  double *r, *b, *g;  // of the bonds
  Matrix A;
};

template <class Shape>
HWY_INLINE NewtonRows newton_rows(const Shape shape, NewtonBatch& batch, const Part& part, double* scratch) {
  const int atoms = 3 * shape.atoms() * kLanes, bonds = shape.size() * kLanes;
  double *r = scratch + 2 * atoms, *b = r + 3 * bonds;
  double* inv_d = batch.factors.of(part.group) + part.first_lane;
  return {scratch, scratch + atoms, r, b, b + bonds, {b + 2 * bonds, inv_d, inv_d + bonds, nullptr}};
}

// r and A's diagonal for the positions before the drift, x − hv.
template <class Shape>
HWY_INLINE void find_old_bonds(const Shape shape, double h, const NewtonRows rows) {
  for (int k = 0; k < shape.size(); ++k) {
    const V3 r = neg_mul_add(all(h), difference(shape, k, rows.v), difference(shape, k, rows.x));
    store3(r, rows.r + 3 * k * kLanes);
    store(hn::Mul(all(shape.bonds[k].reduced_inv_mass), dot(r, r)), rows.A.d + k * kLanes);
  }
}

// b = −σ at x
template <class Shape>
HWY_INLINE Worst find_sigma(const Shape shape, const NewtonRows rows) {
  Worst worst;
  for (int k = 0; k < shape.size(); ++k) {
    const V3 r = difference(shape, k, rows.x);
    const V offset = hn::Sub(dot(r, r), all(shape.bonds[k].length2));
    worst.see(hn::Mul(hn::Abs(offset), all(shape.bonds[k].half_inv_length2)));
    store(hn::Mul(all(-0.5), offset), rows.b + k * kLanes);
  }
  return worst;
}

// x += M⁻¹J(x_old)ᵀb, g += b
template <class Shape>
HWY_INLINE void correct(const Shape shape, const NewtonRows rows) {
  for (int k = 0; k < shape.size(); ++k) {
    const V b = load(rows.b + k * kLanes);
    store(hn::Add(load(rows.g + k * kLanes), b), rows.g + k * kLanes);
    move(shape, k, b, load3(rows.r + 3 * k * kLanes), rows.x);
  }
}

template <class Shape>
HWY_INLINE void newton_positions_of(const Shape shape, NewtonBatch& batch, const NewtonStep& step,
                                    const Part& part, double* scratch, SolveStats& stats) {
  const NewtonRows rows = newton_rows(shape, batch, part, scratch);
  double* lambda = batch.lambda.of(part.group) + part.first_lane;
  gather(part, shape.atoms(), step.x, rows.x);
  gather(part, shape.atoms(), step.v, rows.v);
  find_old_bonds(shape, step.h, rows);
  if (!step.factored && !regular(part, eliminate(shape, rows.A, rows.r, rows.b), rows.A.d, stats)) return;

  for (int k = 0; k < shape.size(); ++k) {
    const V g = hn::Mul(all(0.5 * step.h * step.h), load(lambda + k * kLanes));
    store(g, rows.g + k * kLanes);
    move(shape, k, g, load3(rows.r + 3 * k * kLanes), rows.x);
  }
  Worst worst = find_sigma(shape, rows);
  int iterations = 0;
  while (!worst.within(step.options.tolerance) && iterations < step.options.max_iterations &&
         worst.within(1e3)) {
    substitute_forward(shape, rows.A.l, rows.b);
    substitute_back(shape, rows.A.inv_d, rows.A.l, rows.b);
    correct(shape, rows);
    worst = find_sigma(shape, rows);
    ++iterations;
  }
  for (int k = 0; k < shape.size(); ++k) {
    const V g = load(rows.g + k * kLanes);
    move(shape, k, hn::Mul(all(1 / step.h), g), load3(rows.r + 3 * k * kLanes), rows.v);
    store(hn::Mul(all(2 / (step.h * step.h)), g), lambda + k * kLanes);
  }
  scatter(part, shape.atoms(), rows.x, step.x);
  scatter(part, shape.atoms(), rows.v, step.v);
  stats.iterations = HWY_MAX(stats.iterations, iterations);
  if (!worst.within(step.options.tolerance)) stats.failure = "no convergence";
  if (!worst.within(stats.max_residual)) {
    find_residuals(part.batch, rows.x, rows.b);
    enter(part, rows.b, stats);
  }
}

template <class Shape>
HWY_INLINE void newton_velocities_of(const Shape shape, NewtonBatch& batch, const NewtonStep& step,
                                     const Part& part, double* scratch, SolveStats& stats) {
  const NewtonRows rows = newton_rows(shape, batch, part, scratch);
  double* lambda = batch.lambda.of(part.group) + part.first_lane;
  gather(part, shape.atoms(), step.x, rows.x);
  gather(part, shape.atoms(), step.v, rows.v);
  for (int k = 0; k < shape.size(); ++k) {
    const V3 r = difference(shape, k, rows.x);
    store3(r, rows.r + 3 * k * kLanes);
    store(hn::Mul(all(shape.bonds[k].reduced_inv_mass), dot(r, r)), rows.A.d + k * kLanes);
    store(hn::Neg(dot(r, difference(shape, k, rows.v))), rows.b + k * kLanes);
  }
  const V margin = eliminate(shape, rows.A, rows.r, rows.b);
  substitute_back(shape, rows.A.inv_d, rows.A.l, rows.b);
  for (int k = 0; k < shape.size(); ++k) {
    const V g = load(rows.b + k * kLanes);
    store(hn::Mul(all(2 / step.h), g), lambda + k * kLanes);
    move(shape, k, g, load3(rows.r + 3 * k * kLanes), rows.v);
  }
  scatter(part, shape.atoms(), rows.v, step.v);
  regular(part, margin, rows.A.d, stats);
}

SolveStats newton_positions(NewtonBatch& batch, const NewtonStep& step, int begin, int end, double* scratch) {
  SolveStats stats;
  for_each_part(batch.lanes, begin, end, scratch, [&](auto shape, const Part& part, double* rows) HWY_ATTR {
    newton_positions_of(shape, batch, step, part, rows, stats);
  });
  return stats;
}

SolveStats newton_velocities(NewtonBatch& batch, const NewtonStep& step, int begin, int end,
                             double* scratch) {
  SolveStats stats{.iterations = 1};
  for_each_part(batch.lanes, begin, end, scratch, [&](auto shape, const Part& part, double* rows) HWY_ATTR {
    newton_velocities_of(shape, batch, step, part, rows, stats);
  });
  return stats;
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(newton_positions);
HWY_EXPORT(newton_velocities);

Batched<Newton>::Batched(const System& sys, const Options& options, double h)
    : Batched(sys, options, h, find_clusters(sys)) {}

Batched<Newton>::Batched(const System& sys, const Options& options, double h, const BondClusters& clusters)
    : options_(options),
      leftover_(sys, clusters.rest, options, h),
      lambda_(Eigen::VectorXd::Zero(sys.bond_count())) {
  for (const ClusterBatch& batch : clusters.batches) {
    LaneBatch lanes(batch);
    LaneRows lambda = rows_of_bonds(lanes), factors(lanes.groups, lanes.bond_count() + lanes.plan.entries());
    runner_.add(lanes);
    batches_.push_back({std::move(lanes), std::move(lambda), std::move(factors)});
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
