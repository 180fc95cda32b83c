#include "constraints/lanes/batched_feedforward.hpp"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "constraints/lanes/batched_feedforward.cpp"
#include <hwy/foreach_target.h>

#include "constraints/lanes/elimination-inl.hpp"

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

template <class Shape>
HWY_INLINE FeedforwardRows feedforward_rows(const Shape shape, double* scratch) {
  const int atoms = 3 * shape.atoms() * kLanes, bonds = shape.size() * kLanes;
  double *r = scratch + 3 * atoms, *b = r + 6 * bonds, *l = b + 3 * bonds;
  return {scratch,
          scratch + atoms,
          scratch + 2 * atoms,
          r,
          r + 3 * bonds,
          b,
          {b + bonds, b + 2 * bonds, l, l + shape.entries() * kLanes}};
}

// λ of the last three steps, for one part.
struct Past {
  double *lambda, *before, *before_that;
};

// r; λ extrapolated, and f += Jᵀλ. Returns the residuals at x.
template <class Shape>
HWY_INLINE Worst extrapolate(const Shape shape, const FeedforwardStep& step, const Past past,
                             const FeedforwardRows rows) {
  const V last = all(step.last), first = all(step.first), second = all(step.second);
  const bool shift = step.shift;
  Worst worst;
  for (int k = 0; k < shape.size(); ++k) {
    const V3 r = difference(shape, k, rows.x);
    store3(r, rows.r + 3 * k * kLanes);
    const V offset = hn::Sub(dot(r, r), all(shape.bonds[k].length2));
    worst.see(hn::Mul(hn::Abs(offset), all(shape.bonds[k].half_inv_length2)));
    V guess = load(past.lambda + k * kLanes);
    if (shift) {
      const V one = guess, two = load(past.before + k * kLanes);
      guess =
          hn::MulAdd(last, one, hn::MulAdd(first, two, hn::Mul(second, load(past.before_that + k * kLanes))));
      store(two, past.before_that + k * kLanes);
      store(one, past.before + k * kLanes);
      store(guess, past.lambda + k * kLanes);
    }
    pull(shape, k, guess, r, rows.f);
  }
  return worst;
}

// What one look ahead finds.
struct Ahead {
  V excess;   // of |σ_next| over `turn`·|r_next·r|, the largest
  V runaway;  // over 10³·|r_next·r|
};

// r_next, b = −σ_next/kick and A's diagonal.
template <class Shape>
HWY_INLINE Ahead look_ahead(const Shape shape, const FeedforwardStep& step, const FeedforwardRows rows) {
  const V h = all(step.h), kick = all(step.kick), scale = all(-0.5 / step.kick), turn = all(step.turn);
  Ahead ahead{all(-1e300), all(-1e300)};
  for (int k = 0; k < shape.size(); ++k) {
    const LaneBond& bond = shape.bonds[k];
    const V3 r = load3(rows.r + 3 * k * kLanes);
    const V3 a = neg_mul_add(all(bond.inv_mass_i), load3(rows.f + shape.i(k)),
                             all(bond.inv_mass_j) * load3(rows.f + shape.j(k)));
    const V3 r_next = mul_add(kick, a, mul_add(h, difference(shape, k, rows.v), r));
    store3(r_next, rows.r_next + 3 * k * kLanes);
    const V twice_sigma = hn::Sub(dot(r_next, r_next), all(bond.length2)), along = dot(r_next, r);
    const V size = hn::Mul(all(0.5), hn::Abs(twice_sigma)), reach = hn::Abs(along);
    ahead.excess = hn::Max(ahead.excess, hn::NegMulAdd(turn, reach, size));
    ahead.runaway = hn::Max(ahead.runaway, hn::NegMulAdd(all(1e3), reach, size));
    store(hn::Mul(scale, twice_sigma), rows.b + k * kLanes);
    store(hn::Mul(all(bond.reduced_inv_mass), along), rows.A.d + k * kLanes);
  }
  return ahead;
}

// λ += b, f += Jᵀb
template <class Shape>
HWY_INLINE void correct(const Shape shape, const Past past, const FeedforwardRows rows) {
  for (int k = 0; k < shape.size(); ++k) {
    const V b = load(rows.b + k * kLanes);
    store(hn::Add(load(past.lambda + k * kLanes), b), past.lambda + k * kLanes);
    pull(shape, k, b, load3(rows.r + 3 * k * kLanes), rows.f);
  }
}

HWY_INLINE void fail(const Part& part, const char* why, SolveStats& stats) {
  stats.failure = why;
  stats.worst_bond = part.batch.bond(part.group, 0, part.first_lane);
}

// Solves until what the last one left is known to be small. False where there is no solution.
template <class Shape>
HWY_INLINE bool solve(const Shape shape, const FeedforwardStep& step, const Part& part, const Past past,
                      const FeedforwardRows rows, SolveStats& stats) {
  for (int n = 1; n <= step.max_solves; ++n) {
    const Ahead ahead = look_ahead(shape, step, rows);
    const V margin = eliminate_turned(shape, rows.A, rows.r_next, rows.r, rows.b);
    substitute_back(shape, rows.A.inv_d, rows.A.u, rows.b);
    correct(shape, past, rows);
    stats.iterations = HWY_MAX(stats.iterations, n);
    if (!hn::AllTrue(D(), hn::Lt(ahead.runaway, hn::Zero(D())))) {
      fail(part, "the bonds run away", stats);
      return false;
    }
    if (!regular(part, margin, rows.A.d, stats)) {
      stats.failure = "A is singular, or a bond turns by 90° in one step";
      return false;
    }
    if (hn::AllTrue(D(), hn::Le(ahead.excess, hn::Zero(D())))) return true;
  }
  fail(part, "no convergence", stats);
  return false;
}

template <class Shape>
HWY_INLINE void feedforward_part(const Shape shape, FeedforwardBatch& batch, const FeedforwardStep& step,
                                 const Part& part, double* scratch, SolveStats& stats) {
  const FeedforwardRows rows = feedforward_rows(shape, scratch);
  const Past past{batch.lambda.of(part.group) + part.first_lane,
                  batch.before.of(part.group) + part.first_lane,
                  batch.before_that.of(part.group) + part.first_lane};
  gather(part, shape.atoms(), step.x, rows.x);
  gather(part, shape.atoms(), step.v, rows.v);
  gather(part, shape.atoms(), step.f, rows.f);
  const Worst worst = extrapolate(shape, step, past, rows);
  const bool solved = solve(shape, step, part, past, rows, stats);
  scatter(part, shape.atoms(), rows.f, step.f);
  if (solved && !worst.within(stats.max_residual)) {
    find_residuals(part.batch, rows.x, rows.b);
    enter(part, rows.b, stats);
  }
}

SolveStats feedforward_groups(FeedforwardBatch& batch, const FeedforwardStep& step, int begin, int end,
                              double* scratch) {
  SolveStats stats;
  for_each_part(batch.lanes, begin, end, scratch, [&](auto shape, const Part& part, double* rows) HWY_ATTR {
    feedforward_part(shape, batch, step, part, rows, stats);
  });
  return stats;
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(feedforward_groups);

Batched<Feedforward>::Batched(const System& sys, const Options& options, double h)
    : Batched(sys, options, h, find_clusters(sys)) {}

Batched<Feedforward>::Batched(const System& sys, const Options& options, double h,
                              const BondClusters& clusters)
    : options_(options),
      h_(h),
      leftover_(sys, clusters.rest, options, h),
      lambda_(Eigen::VectorXd::Zero(sys.bond_count())) {
  for (const ClusterBatch& batch : clusters.batches) {
    LaneBatch lanes(batch);
    LaneRows lambda = rows_of_bonds(lanes), before = rows_of_bonds(lanes), before_that = rows_of_bonds(lanes);
    runner_.add(lanes);
    batches_.push_back({std::move(lanes), std::move(lambda), std::move(before), std::move(before_that)});
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
