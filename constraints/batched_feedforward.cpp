#include "constraints/batched_feedforward.hpp"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "constraints/batched_feedforward.cpp"
#include <hwy/foreach_target.h>

#include "constraints/lanes-inl.hpp"

#ifndef TAUT_FEEDFORWARD_STEP
#define TAUT_FEEDFORWARD_STEP
namespace taut {
struct FeedforwardStep {
  double h, kick;              // δ = h v + kick·M⁻¹f
  double last, first, second;  // λ ← last·λ₁ + first·λ₂ + second·λ₃
  bool shift;                  // λ₁ and λ₂ become the past
  int max_solves;
  double turn;  // |σ_next / r_next·r| up to which one solve leaves less than the tolerance
  const double *x, *v;
  double* f;
};
}  // namespace taut
#endif

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

// Scratch of one part.
struct FeedforwardRows {
  double *x, *v, *f;       // of the atoms
  double *r, *r_next, *b;  // of the bonds
  Matrix A;
};

HWY_INLINE FeedforwardRows feedforward_rows(const FeedforwardBatch& batch, double* scratch) {
  const int atoms = 3 * batch.lanes.atoms * kWidth, bonds = batch.plan.size() * kWidth;
  double *r = scratch + 3 * atoms, *b = r + 6 * bonds, *l = b + 3 * bonds;
  return {scratch,
          scratch + atoms,
          scratch + 2 * atoms,
          r,
          r + 3 * bonds,
          b,
          {batch.plan, b + bonds, b + 2 * bonds, l, l + batch.plan.entries() * kWidth}};
}

// r; λ extrapolated, and f += Jᵀλ. Returns the residuals at x.
HWY_INLINE Worst extrapolate(FeedforwardBatch& batch, const FeedforwardStep& step, const Part& part,
                             const FeedforwardRows rows) {
  const int n = batch.plan.size();
  const LaneBond* bonds = batch.lanes.bonds.data();
  double *lambda = batch.lambda.of(part.group) + part.first_lane,
         *before = batch.before.of(part.group) + part.first_lane,
         *before_that = batch.before_that.of(part.group) + part.first_lane;
  const V last = all(step.last), first = all(step.first), second = all(step.second);
  const bool shift = step.shift;
  Worst worst;
  for (int k = 0; k < n; ++k) {
    const V3 r = load3(rows.x + bonds[k].j * kWidth) - load3(rows.x + bonds[k].i * kWidth);
    store3(r, rows.r + 3 * k * kWidth);
    worst.see(hn::Mul(hn::Abs(hn::Sub(dot(r, r), all(bonds[k].length2))), all(bonds[k].half_inv_length2)));
    V guess = load(lambda + k * kLanes);
    if (shift) {
      const V one = guess, two = load(before + k * kLanes);
      guess = hn::MulAdd(last, one, hn::MulAdd(first, two, hn::Mul(second, load(before_that + k * kLanes))));
      store(two, before_that + k * kLanes);
      store(one, before + k * kLanes);
      store(guess, lambda + k * kLanes);
    }
    pull(bonds[k], guess, r, rows.f);
  }
  return worst;
}

// What one look ahead finds.
struct Ahead {
  V excess;   // of |σ_next| over `turn`·|r_next·r|, the largest
  V runaway;  // over 10³·|r_next·r|
};

// r_next, b = −σ_next/kick and A's diagonal.
HWY_INLINE Ahead look_ahead(const FeedforwardBatch& batch, const FeedforwardStep& step,
                            const FeedforwardRows rows) {
  const int n = batch.plan.size();
  const LaneBond* bonds = batch.lanes.bonds.data();
  const V h = all(step.h), kick = all(step.kick), scale = all(-0.5 / step.kick), turn = all(step.turn);
  Ahead ahead{all(-1e300), all(-1e300)};
  for (int k = 0; k < n; ++k) {
    const int i = bonds[k].i * kWidth, j = bonds[k].j * kWidth;
    const V3 r = load3(rows.r + 3 * k * kWidth);
    const V3 a = neg_mul_add(all(bonds[k].inv_mass_i), load3(rows.f + i),
                             all(bonds[k].inv_mass_j) * load3(rows.f + j));
    const V3 r_next = mul_add(kick, a, mul_add(h, load3(rows.v + j) - load3(rows.v + i), r));
    store3(r_next, rows.r_next + 3 * k * kWidth);
    const V twice_sigma = hn::Sub(dot(r_next, r_next), all(bonds[k].length2)), along = dot(r_next, r);
    const V size = hn::Mul(all(0.5), hn::Abs(twice_sigma)), reach = hn::Abs(along);
    ahead.excess = hn::Max(ahead.excess, hn::NegMulAdd(turn, reach, size));
    ahead.runaway = hn::Max(ahead.runaway, hn::NegMulAdd(all(1e3), reach, size));
    store(hn::Mul(scale, twice_sigma), rows.b + k * kWidth);
    store(hn::Mul(all(bonds[k].reduced_inv_mass), along), rows.A.d + k * kWidth);
  }
  return ahead;
}

// λ += b, f += Jᵀb
HWY_INLINE void correct(FeedforwardBatch& batch, const Part& part, const FeedforwardRows rows) {
  const int n = batch.plan.size();
  const LaneBond* bonds = batch.lanes.bonds.data();
  double* lambda = batch.lambda.of(part.group) + part.first_lane;
  for (int k = 0; k < n; ++k) {
    const V b = load(rows.b + k * kWidth);
    store(hn::Add(load(lambda + k * kLanes), b), lambda + k * kLanes);
    pull(bonds[k], b, load3(rows.r + 3 * k * kWidth), rows.f);
  }
}

void feedforward_part(FeedforwardBatch& batch, const FeedforwardStep& step, const Part& part, double* scratch,
                      SolveStats& stats) {
  const FeedforwardRows rows = feedforward_rows(batch, scratch);
  gather(part, step.x, rows.x);
  gather(part, step.v, rows.v);
  gather(part, step.f, rows.f);
  const Worst worst = extrapolate(batch, step, part, rows);
  if (!worst.within(stats.max_residual)) {
    find_residuals(batch.lanes, rows.x, rows.b);
    enter(part, rows.b, stats);
  }
  for (int solve = 1;; ++solve) {
    const Ahead ahead = look_ahead(batch, step, rows);
    if (!hn::AllTrue(D(), hn::Lt(ahead.runaway, hn::Zero(D())))) {
      stats.failure = "the bonds run away";
      stats.worst_bond = part.batch.bond(part.group, 0, part.first_lane);
      return;
    }
    couple(batch.plan, rows.r_next, rows.r, rows.A.l);
    couple(batch.plan, rows.r, rows.r_next, rows.A.u);
    const V margin = eliminate_turned(rows.A, batch.lanes.bonds.data(), rows.b);
    if (!regular(part, margin, rows.A.d, stats)) {
      stats.failure = "A is singular, or a bond turns by 90° in one step";
      return;
    }
    substitute_back(batch.plan, rows.A.inv_d, rows.A.u, rows.b);
    correct(batch, part, rows);
    stats.iterations = HWY_MAX(stats.iterations, solve);
    if (hn::AllTrue(D(), hn::Le(ahead.excess, hn::Zero(D())))) break;
    if (solve == step.max_solves) {
      stats.failure = "no convergence";
      stats.worst_bond = part.batch.bond(part.group, 0, part.first_lane);
      break;
    }
  }
  scatter(part, rows.f, step.f);
}

SolveStats feedforward_groups(FeedforwardBatch& batch, const FeedforwardStep& step, int begin, int end,
                              double* scratch) {
  SolveStats stats;
  for_each_part(batch.lanes, begin, end,
                [&](const Part& part) HWY_ATTR { feedforward_part(batch, step, part, scratch, stats); });
  return stats;
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(feedforward_groups);

Batched<Feedforward>::Batched(const System& sys, const Options& options, double h)
    : Batched(sys, options, h, find_clusters(sys, kMostBondsInLanes)) {}

Batched<Feedforward>::Batched(const System& sys, const Options& options, double h,
                              const BondClusters& clusters)
    : options_(options),
      h_(h),
      leftover_(sys, clusters.rest, options, h),
      lambda_(Eigen::VectorXd::Zero(sys.bond_count())) {
  for (const ClusterBatch& batch : clusters.batches) {
    Elimination plan(batch.shape);
    LaneBatch lanes(batch, plan.order);
    runner_.add(lanes, scratch_rows(lanes, plan));
    const auto rows = [&] { return LaneRows(lanes.groups, plan.size()); };
    LaneRows lambda = rows(), before = rows(), before_that = rows();
    batches_.push_back(
        {std::move(lanes), std::move(plan), std::move(lambda), std::move(before), std::move(before_that)});
  }
}

SolveStats Batched<Feedforward>::add_forces(const System&, double h, State& s) {
  // At the start v is the full-step velocity and the coming kick half as long.
  const bool start = h == 0;
  const int order = std::min(options_.extrapolation, known_ - 1);
  const FeedforwardStep step{.h = h_,
                             .kick = start ? 0.5 * h_ * h_ : h_ * h_,
                             .last = order == 1   ? 2.0
                                     : order == 2 ? 3.0
                                                  : 1.0,
                             .first = order == 1   ? -1.0
                                      : order == 2 ? -3.0
                                                   : 0.0,
                             .second = order == 2 ? 1.0 : 0.0,
                             .shift = !start,
                             .max_solves = options_.max_solves,
                             .turn = std::sqrt(2 * options_.tolerance),
                             .x = s.x.data(),
                             .v = s.v.data(),
                             .f = s.f.data()};
  known_ = start ? 1 : std::min(known_ + 1, 3);
  SolveStats stats = runner_.run([&](int b, int begin, int end, double* scratch) {
    return HWY_DYNAMIC_DISPATCH(feedforward_groups)(batches_[b], step, begin, end, scratch);
  });
  LaneRunner::merge(stats, leftover_.add_forces(h, s));
  return stats;
}

const Eigen::VectorXd& Batched<Feedforward>::lambda() const {
  for (const FeedforwardBatch& batch : batches_) rows_to_bonds(batch.lanes, batch.lambda, lambda_);
  leftover_.write_lambda(lambda_);
  return lambda_;
}

}  // namespace taut
#endif
