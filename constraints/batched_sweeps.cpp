#include "constraints/batched_sweeps.hpp"

#include <numeric>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "constraints/batched_sweeps.cpp"
#include <hwy/foreach_target.h>

#include "constraints/lanes-inl.hpp"

#ifndef TAUT_SWEEP_STEP
#define TAUT_SWEEP_STEP
namespace taut {
struct SweepStep {
  SweepLimits limits;
  double h, guess, keep;
  double *x, *v;
};
}  // namespace taut
#endif

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

// Scratch of one part.
struct SweepRows {
  double *x, *v;                   // of the atoms
  double *r, *g, *inv, *relative;  // of the bonds; r: along which corrections act
};

HWY_INLINE SweepRows sweep_rows(const LaneBatch& lanes, double* scratch) {
  const int atoms = 3 * lanes.atoms * kWidth, bonds = lanes.bond_count() * kWidth;
  double *r = scratch + 2 * atoms, *g = r + 3 * bonds;
  return {scratch, scratch + atoms, r, g, g + bonds, g + 2 * bonds};
}

// g = guess·λ, y += M⁻¹Jᵀg
HWY_INLINE void set_out(const LaneBatch& lanes, double guess, const double* lambda, const SweepRows rows,
                        double* y) {
  for (int k = 0; k < lanes.bond_count(); ++k) {
    const V g = hn::Mul(all(guess), load(lambda + k * kLanes));
    store(g, rows.g + k * kWidth);
    move(lanes.bonds[k], g, load3(rows.r + 3 * k * kWidth), y);
  }
}

HWY_INLINE void keep(const LaneBatch& lanes, double scale, const SweepRows rows, double* lambda) {
  for (int k = 0; k < lanes.bond_count(); ++k)
    store(hn::Mul(all(scale), load(rows.g + k * kWidth)), lambda + k * kLanes);
}

// Adds dg where it is wanted.
HWY_INLINE void correct(const LaneBond& bond, int k, V dg, const SweepRows rows, double* y) {
  store(hn::Add(load(rows.g + k * kWidth), dg), rows.g + k * kWidth);
  move(bond, dg, load3(rows.r + 3 * k * kWidth), y);
}

struct SweepOfPositions {
  // One sweep; what it met is left in rows.relative. False in lanes where a bond turned by 90°.
  HWY_INLINE V operator()(const LaneBatch& lanes, double tolerance, const SweepRows rows,
                          Worst& worst) const {
    const int n = lanes.bond_count();
    const LaneBond* bonds = lanes.bonds.data();
    V margin = all(1e300);
    for (int k = 0; k < n; ++k) {
      const LaneBond& bond = bonds[k];
      const V3 r = load3(rows.x + bond.j * kWidth) - load3(rows.x + bond.i * kWidth);
      const V offset = hn::Sub(dot(r, r), all(bond.length2)), along = dot(r, load3(rows.r + 3 * k * kWidth));
      const V relative = hn::Mul(hn::Abs(offset), all(bond.half_inv_length2));
      worst.see(relative);
      store(relative, rows.relative + k * kWidth);
      const auto off = hn::Gt(relative, all(tolerance));
      margin =
          hn::Min(margin, hn::IfThenElse(off, hn::NegMulAdd(all(1e-6), all(bond.length2), along), margin));
      const V dg = hn::Div(hn::Mul(all(-0.5), offset), hn::Mul(all(bond.reduced_inv_mass), along));
      correct(bond, k, hn::IfThenElseZero(off, dg), rows, rows.x);
    }
    return margin;
  }
  static constexpr const char* kNoConvergence = "no convergence";
};

struct SweepOfVelocities {
  double h;
  HWY_INLINE V operator()(const LaneBatch& lanes, double tolerance, const SweepRows rows,
                          Worst& worst) const {
    const int n = lanes.bond_count();
    const LaneBond* bonds = lanes.bonds.data();
    for (int k = 0; k < n; ++k) {
      const LaneBond& bond = bonds[k];
      const V3 v = load3(rows.v + bond.j * kWidth) - load3(rows.v + bond.i * kWidth);
      const V rate = dot(load3(rows.r + 3 * k * kWidth), v);
      const V relative = hn::Mul(hn::Abs(rate), all(2 * h * bond.half_inv_length2));
      worst.see(relative);
      store(relative, rows.relative + k * kWidth);
      const V dg = hn::Neg(hn::Mul(rate, load(rows.inv + k * kWidth)));
      correct(bond, k, hn::IfThenElseZero(hn::Gt(relative, all(tolerance)), dg), rows, rows.v);
    }
    return all(1);
  }
  static constexpr const char* kNoConvergence = "no convergence of the velocities";
};

// Sweeps until all hold, or as many as asked for.
template <class Sweep>
HWY_INLINE void repeat(const Sweep& sweep, const SweepLimits& limits, const Part& part, const SweepRows rows,
                       SolveStats& stats) {
  const bool fixed = limits.sweeps > 0;
  const int most = fixed ? limits.sweeps : limits.max_sweeps;
  for (int n = 1; n <= most; ++n) {
    Worst worst;
    const V margin = sweep(part.batch, fixed ? 0.0 : limits.tolerance, rows, worst);
    stats.iterations = HWY_MAX(stats.iterations, n);
    const bool turned = !hn::AllTrue(D(), hn::Gt(margin, hn::Zero(D())));
    const bool held = !fixed && worst.within(limits.tolerance);
    if (!held && !turned && n < most) continue;
    if (!worst.within(stats.max_residual)) enter(part, rows.relative, stats);
    if (turned) stats.failure = "the bond turned by 90° in one step";
    if (!turned && !held && !fixed) stats.failure = Sweep::kNoConvergence;
    return;
  }
}

void sweep_positions_of(SweepBatch& batch, const SweepStep& step, const Part& part, double* scratch,
                        SolveStats& stats) {
  const LaneBatch& lanes = batch.lanes;
  const SweepRows rows = sweep_rows(lanes, scratch);
  double* lambda = batch.lambda.of(part.group) + part.first_lane;
  gather(part, step.x, rows.x);
  gather(part, step.v, rows.v);
  for (int k = 0; k < lanes.bond_count(); ++k) {
    const int i = lanes.bonds[k].i * kWidth, j = lanes.bonds[k].j * kWidth;
    store3(neg_mul_add(all(step.h), load3(rows.v + j) - load3(rows.v + i),
                       load3(rows.x + j) - load3(rows.x + i)),
           rows.r + 3 * k * kWidth);
  }
  set_out(lanes, step.guess, lambda, rows, rows.x);
  repeat(SweepOfPositions{}, step.limits, part, rows, stats);
  for (int k = 0; k < lanes.bond_count(); ++k)
    move(lanes.bonds[k], hn::Mul(all(1 / step.h), load(rows.g + k * kWidth)), load3(rows.r + 3 * k * kWidth),
         rows.v);
  keep(lanes, step.keep, rows, lambda);
  scatter(part, rows.x, step.x);
  scatter(part, rows.v, step.v);
}

void sweep_velocities_of(SweepBatch& batch, const SweepStep& step, const Part& part, double* scratch,
                         SolveStats& stats) {
  const LaneBatch& lanes = batch.lanes;
  const SweepRows rows = sweep_rows(lanes, scratch);
  double* lambda = batch.lambda.of(part.group) + part.first_lane;
  gather(part, step.x, rows.x);
  gather(part, step.v, rows.v);
  for (int k = 0; k < lanes.bond_count(); ++k) {
    const LaneBond& bond = lanes.bonds[k];
    const V3 r = load3(rows.x + bond.j * kWidth) - load3(rows.x + bond.i * kWidth);
    store3(r, rows.r + 3 * k * kWidth);
    store(hn::Div(all(1), hn::Mul(all(bond.reduced_inv_mass), dot(r, r))), rows.inv + k * kWidth);
  }
  set_out(lanes, step.guess, lambda, rows, rows.v);
  repeat(SweepOfVelocities{step.h}, step.limits, part, rows, stats);
  keep(lanes, step.keep, rows, lambda);
  scatter(part, rows.v, step.v);
}

SolveStats sweep_positions(SweepBatch& batch, const SweepStep& step, int begin, int end, double* scratch) {
  SolveStats stats;
  for_each_part(batch.lanes, begin, end,
                [&](const Part& part) HWY_ATTR { sweep_positions_of(batch, step, part, scratch, stats); });
  return stats;
}

SolveStats sweep_velocities(SweepBatch& batch, const SweepStep& step, int begin, int end, double* scratch) {
  SolveStats stats;
  for_each_part(batch.lanes, begin, end,
                [&](const Part& part) HWY_ATTR { sweep_velocities_of(batch, step, part, scratch, stats); });
  return stats;
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(sweep_positions);
HWY_EXPORT(sweep_velocities);

LaneSweeps::LaneSweeps(const System&, const BondClusters& clusters, SweepLimits limits) : limits_(limits) {
  for (const ClusterBatch& batch : clusters.batches) {
    std::vector<int> order(batch.shape.bond_count());
    std::iota(order.begin(), order.end(), 0);
    LaneBatch lanes(batch, order);
    runner_.add(lanes, 6 * lanes.atoms + 6 * lanes.bond_count());
    LaneRows lambda(lanes.groups, lanes.bond_count());
    batches_.push_back({std::move(lanes), std::move(lambda)});
  }
}

SolveStats LaneSweeps::positions(double h, double guess, double keep, State& s) {
  const SweepStep step{limits_, h, guess, keep, s.x.data(), s.v.data()};
  return runner_.run([&](int b, int begin, int end, double* scratch) {
    return HWY_DYNAMIC_DISPATCH(sweep_positions)(batches_[b], step, begin, end, scratch);
  });
}

SolveStats LaneSweeps::velocities(double h, double guess, double keep, State& s) {
  const SweepStep step{limits_, h, guess, keep, s.x.data(), s.v.data()};
  return runner_.run([&](int b, int begin, int end, double* scratch) {
    return HWY_DYNAMIC_DISPATCH(sweep_velocities)(batches_[b], step, begin, end, scratch);
  });
}

void LaneSweeps::write_lambda(Eigen::VectorXd& lambda) const {
  for (const SweepBatch& batch : batches_) rows_to_bonds(batch.lanes, batch.lambda, lambda);
}

Batched<Shake>::Batched(const System& sys, const Options& options, double h)
    : Batched(sys, options, h, find_clusters(sys, kMostBondsInLanes)) {}

Batched<Shake>::Batched(const System& sys, const Options& options, double h, const BondClusters& clusters)
    : leftover_(sys, clusters.rest, options, h),
      sweeps_(sys, clusters, {options.tolerance, options.max_sweeps, options.sweeps}),
      lambda_(Eigen::VectorXd::Zero(sys.bond_count())) {}

SolveStats Batched<Shake>::project_positions(const System&, double h, State& s) {
  SolveStats stats = sweeps_.positions(h, h * h, 1 / (h * h), s);
  LaneRunner::merge(stats, leftover_.project_positions(h, s));
  return stats;
}

const Eigen::VectorXd& Batched<Shake>::lambda() const {
  sweeps_.write_lambda(lambda_);
  leftover_.write_lambda(lambda_);
  return lambda_;
}

Batched<Rattle>::Batched(const System& sys, const Options& options, double h)
    : Batched(sys, options, h, find_clusters(sys, kMostBondsInLanes)) {}

Batched<Rattle>::Batched(const System& sys, const Options& options, double h, const BondClusters& clusters)
    : warm_start_(options.warm_start),
      leftover_(sys, clusters.rest, options, h),
      sweeps_(sys, clusters, {options.tolerance, options.max_sweeps, options.sweeps}),
      lambda_(Eigen::VectorXd::Zero(sys.bond_count())) {}

SolveStats Batched<Rattle>::project_positions(const System&, double h, State& s) {
  SolveStats stats = sweeps_.positions(h, warm_start_ ? 0.5 * h * h : 0.0, 2 / (h * h), s);
  LaneRunner::merge(stats, leftover_.project_positions(h, s));
  return stats;
}

SolveStats Batched<Rattle>::project_velocities(const System&, double h, State& s) {
  SolveStats stats = sweeps_.velocities(h, warm_start_ ? 0.5 * h : 0.0, 2 / h, s);
  LaneRunner::merge(stats, leftover_.project_velocities(h, s));
  return stats;
}

const Eigen::VectorXd& Batched<Rattle>::lambda() const {
  sweeps_.write_lambda(lambda_);
  leftover_.write_lambda(lambda_);
  return lambda_;
}

}  // namespace taut
#endif
