#include "constraints/batch/batched_baumgarte.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "constraints/batch/batched_baumgarte.cpp"
#include <hwy/foreach_target.h>

#include "constraints/batch/past_lambda-inl.hpp"
#include "constraints/batch/triangles-inl.hpp"

#ifndef TAUT_BAUMGARTE_STEP
#define TAUT_BAUMGARTE_STEP
namespace taut {
struct BaumgarteStep {
  double h, h_kick;            // δ = h v + h_kick M⁻¹(f + noise)
  double last, first, second;  // λ ← last·λ₁ + first·λ₂ + second·λ₃
  bool shift;                  // whether λ is extrapolated, and the previous one stored
  int max_solves;
  double turn;  // largest |(σ₊ − τ) / r₊·r| for which one solve is within the tolerance
  const double *x, *v, *noise;  // noise: null for none
  double* f;
};
}  // namespace taut
#endif

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

struct BaumgarteRows {
  double *x, *v, *f;    // 3 × atoms
  double *r, *r_next;   // 3 × bonds
  double* twice_sigma;  // bonds

  HWY_INLINE BaumgarteRows(const auto shape, Scratch& scratch)
      : x(scratch.take(3 * shape.atoms())),
        v(scratch.take(3 * shape.atoms())),
        f(scratch.take(3 * shape.atoms())),
        r(scratch.take(3 * shape.size())),
        r_next(scratch.take(3 * shape.size())),
        twice_sigma(scratch.take(shape.size())) {}
};

// Computes r, extrapolates λ, and adds Jᵀλ to f. Returns the residuals at x.
template <class Shape>
HWY_INLINE Worst extrapolate(const Shape shape, const BaumgarteStep& step, const PastLambda past,
                             const BaumgarteRows rows) {
  const double last = step.last, first = step.first, second = step.second;
  const auto foretold = [=](V one, V two, V three)
                            HWY_ATTR { return second * three + first * two + last * one; };
  const bool shift = step.shift;
  Worst worst;
  for (int k = 0; k < shape.size(); ++k) {
    const V3 r = difference(shape, k, rows.x);
    store3(r, rows.r + 3 * k * kLanes);
    const V twice = twice_sigma(shape.bonds[k], r);
    store(twice, rows.twice_sigma + k * kLanes);
    worst.include(shape.bonds[k], twice);
    const V guess = shift ? past.shift(k, foretold) : load(past.lambda + k * kLanes);
    add_constraint_force(shape, k, guess, r, rows.f);
  }
  return worst;
}

// Conditions on all bonds of a lane; a NaN fails both.
struct Ahead {
  M near;  // |σ₊ − τ| ≤ `turn`·|r₊·r|: one solve suffices
  M sane;  // < 10³·|r₊·r|
};

// Computes r₊, b = −(σ₊ − τ)/h_kick and the diagonal of A'.
template <class Shape>
HWY_INLINE Ahead look_ahead(const Shape shape, const BaumgarteStep& step, const LaneLaw* laws,
                            const BaumgarteRows rows, const Equations& eq) {
  const double h = step.h, h_kick = step.h_kick, scale = -0.5 / h_kick, turn = step.turn;
  Ahead ahead{all_lanes(), all_lanes()};
  for (int k = 0; k < shape.solved(); ++k) {
    const LaneBond& bond = shape.bonds[k];
    const V3 r = load3(rows.r + 3 * k * kLanes);
    const V3 a = bond.inv_mass_j * load3(rows.f + shape.j(k)) - bond.inv_mass_i * load3(rows.f + shape.i(k));
    const V3 v = difference(shape, k, rows.v);
    const V3 r_next = r + h * v + h_kick * a;
    store3(r_next, rows.r_next + 3 * k * kLanes);
    V off = twice_sigma(bond, r_next);  // 2(σ₊ − τ)
    off -= laws[k].of_sigma * load(rows.twice_sigma + k * kLanes);
    off -= laws[k].of_rate * dot(r - 0.5 * h * v, v);
    const V along = dot(r_next, r);
    const V size = 0.5 * hn::Abs(off), reach = hn::Abs(along);
    ahead.near = hn::And(ahead.near, size <= turn * reach);
    ahead.sane = hn::And(ahead.sane, size < 1e3 * reach);
    store(scale * off, eq.b + k * kLanes);
    store(bond.reduced_inv_mass * along, eq.A.d + k * kLanes);
  }
  return ahead;
}

// λ += b, f += Jᵀb
template <class Shape>
HWY_INLINE void apply_change(const Shape shape, const double* change, const PastLambda past,
                             const BaumgarteRows rows) {
  for (int k = 0; k < shape.size(); ++k) {
    const V b = load(change + k * kLanes);
    store(load(past.lambda + k * kLanes) + b, past.lambda + k * kLanes);
    add_constraint_force(shape, k, b, load3(rows.r + 3 * k * kLanes), rows.f);
  }
}

// Reports the failure, and the bond of the largest |b|; a NaN counts as the largest.
HWY_NOINLINE void fail(const Part& part, const double* b, Failure why, SolveStats& stats) {
  stats.failure = why;
  double largest = -1;
  for (int k = 0; k < part.batch.plan.solved; ++k)
    for (int l = 0; l < kWidth; ++l) {
      const double size = std::abs(b[k * kLanes + l]);
      if (size <= largest || largest != largest) continue;
      largest = size;
      stats.worst_bond = part.batch.bond(part.group, k, part.first_lane + l);
    }
}

template <class Shape>
struct BaumgarteKernel {
  static constexpr bool kOnceMostly = true;
  const Shape shape;
  const BaumgarteStep& step;
  const Part& part;
  const LaneLaw* laws;
  PastLambda past;
  Equations eq;
  BaumgarteRows rows;
  double* x;
  Worst worst;

  HWY_INLINE BaumgarteKernel(const Shape its_shape, BaumgarteBatch& batch, const BaumgarteStep& its_step,
                             const Part& its_part, Scratch& scratch)
      : shape(its_shape),
        step(its_step),
        part(its_part),
        laws(batch.laws.data()),
        past(batch, part),
        eq(equations(shape, scratch)),
        rows(shape, scratch),
        x(rows.x) {}

  // Starts from λ of the last step where the extrapolated one led astray, as it does where bonds turn far in a step.
  static std::optional<BaumgarteStep> start_anew(BaumgarteBatch& batch, const BaumgarteStep& step,
                                                 const Part& part) {
    if (!step.shift || step.first == 0) return std::nullopt;
    const PastLambda past(batch, part);
    for (int k = 0; k < batch.lanes.bond_count(); ++k)
      store(load(past.before + k * kLanes), past.lambda + k * kLanes);
    BaumgarteStep anew = step;
    anew.shift = false;
    return anew;
  }
  // If σ₊ − τ is small, the error after one solve is below the tolerance.
  HWY_INLINE SolveNext look(SolveStats& stats) {
    const Ahead ahead = look_ahead(shape, step, laws, rows, eq);
    if (!hn::AllTrue(D(), ahead.sane)) {
      fail(part, eq.b, Failure::kRanAway, stats);
      return SolveNext::kEnd;
    }
    return hn::AllTrue(D(), ahead.near) ? SolveNext::kLastSolve : SolveNext::kSolve;
  }
  HWY_INLINE SolveNext start(SolveStats& stats) {
    gather(part, shape.atoms(), step.x, rows.x);
    gather_sum(part, shape.atoms(), step.f, step.noise, rows.v, rows.f);
    gather(part, shape.atoms(), step.v, rows.v);
    worst = extrapolate(shape, step, past, rows);
    return look(stats);
  }
  HWY_INLINE bool forward(int, SolveStats& stats) {
    const bool regular = factor(shape, part, eq, rows.r_next, rows.r, stats);
    if (!regular) stats.failure = Failure::kSingularOrTurned;
    return regular;
  }
  HWY_INLINE void back() { substitute_back(shape, eq.A.inv_d, eq.A.u, eq.b); }
  HWY_INLINE SolveNext apply(SolveNext last, int solves, SolveStats& stats) {
    apply_change(shape, eq.b, past, rows);
    if (last == SolveNext::kLastSolve) return SolveNext::kEnd;
    if (solves < step.max_solves) return look(stats);
    fail(part, eq.b, Failure::kNoConvergence, stats);
    return SolveNext::kEnd;
  }
  HWY_INLINE void end(SolveStats& stats) {
    if (step.noise) forces_without_noise(shape, part, step.f, past.lambda, rows.r, rows.f);
    scatter(shape, part, rows.f, step.f);
    if (!stats.converged() || worst.within(stats.max_residual)) return;  // a larger one is known
    find_residuals(part.batch, rows.x, eq.b);
    record_largest(part, eq.b, stats);
  }
};

// The same for triangles, in differences between the atoms of a bond. δ = h v + h_kick M⁻¹f is put together
// where it lies in memory, and Jᵀλ added to f there.
struct BaumgarteTriangle {
  const LaneBatch& lanes;
  const BaumgarteStep& step;
  InverseMasses masses;
  Sides r, r_next;
  Three target;          // 2τ
  Three lambda, change;  // change is not part of r_next yet
  bool near, regular;    // as in Ahead; false for NaN

  HWY_INLINE void solve() {
    r_next = r_next + step.h_kick * Forces(change, r).accelerations(masses);
    const TriangleMatrix A(lanes, r_next, r);
    Three off = twice_sigma(lanes, r_next);
    M close = all_lanes();
    Three b;
    for (int k = 0; k < 3; ++k) {
      off.k[k] -= target.k[k];
      close = hn::And(close, hn::Abs(off.k[k]) <= 2 * step.turn * hn::Abs(A.along.k[k]));
      b.k[k] = -0.5 / step.h_kick * off.k[k];
    }
    near = hn::AllTrue(D(), close);
    regular = hn::AllTrue(D(), A.regular(lanes));
    change = A.solve(b);
    lambda = lambda + change;
  }
};

HWY_INLINE bool solve_triangle(BaumgarteBatch& batch, const BaumgarteStep& step, const double* h_kick_by_mass,
                               const Part& part, SolveStats& stats) {
  HWY_ALIGN double copies[4][9 * kWidth];
  const Nines nines(part);
  const double *x = nines.open(step.x, copies[0]), *v = nines.open(step.v, copies[1]);
  const double* noise = step.noise ? nines.open(step.noise, copies[3]) : nullptr;
  double* f = nines.open(step.f, copies[2]);
  const LaneBatch& lanes = batch.lanes;
  const PastLambda past(batch, part);

  const Sides r = sides(rows_of(load_nine(x)));
  const Three now = twice_sigma(lanes, r);
  const Worst worst = worst_of(lanes, now);
  Nine velocity, delta;
  for (int k = 0; k < 9; ++k) {
    velocity.n[k] = load_any(v + k * kWidth);
    delta.n[k] = hn::MulAdd(broadcast(step.h), velocity.n[k],
                            load(h_kick_by_mass + k * kWidth) * load_any(f + k * kWidth));
  }
  const Three before = twice_sigma(lanes, r - step.h * sides(rows_of(velocity)));
  Three target;
  for (int k = 0; k < 3; ++k)
    target.k[k] = hn::MulSub(broadcast(batch.laws[k].now), now.k[k], batch.laws[k].before * before.k[k]);
  if (noise)
    for (int k = 0; k < 9; ++k)
      delta.n[k] += load(h_kick_by_mass + k * kWidth) * load_any(noise + k * kWidth);
  const Three one = load_three(past.lambda), two = load_three(past.before),
              three = load_three(past.before_that);
  Three guess;
  for (int k = 0; k < 3; ++k)
    guess.k[k] = step.second * three.k[k] + step.first * two.k[k] + step.last * one.k[k];
  BaumgarteTriangle triangle{.lanes = lanes,
                             .step = step,
                             .masses = InverseMasses(lanes),
                             .r = r,
                             .r_next = r + sides(rows_of(delta)),
                             .target = target,
                             .lambda = guess,
                             .change = guess,
                             .near = false,
                             .regular = false};
  triangle.solve();
  int solves = 1;
  for (; !triangle.near && triangle.regular && solves < step.max_solves; ++solves) triangle.solve();
  if (!triangle.near || !triangle.regular) return false;
  stats.iterations = solves;
  store_three(two, past.before_that);
  store_three(one, past.before);
  store_three(triangle.lambda, past.lambda);
  const Nine force = numbers_of(Forces(triangle.lambda, r).rows());
  for (int k = 0; k < 9; ++k) store_any(load_any(f + k * kWidth) + force.n[k], f + k * kWidth);
  nines.close(f, step.f);
  if (!worst.within(stats.max_residual)) enter_residuals(part, step.x, stats);
  return true;
}

SolveStats baumgarte_groups(BaumgarteBatch& batch, const BaumgarteStep& step, const SolveCall& call,
                            int begin, int end, const Scratch& scratch) {
  if (batch.lanes.triangle && step.shift) {
    HWY_ALIGN double h_kick_by_mass[9 * kWidth];
    for (int n = 0; n < 9 * kWidth; ++n) h_kick_by_mass[n] = step.h_kick * batch.lanes.inv_mass[n % 9 / 3];
    return solve_triangles<BaumgarteKernel>(batch, step, {begin, end, scratch},
                                            [&](const Part& part, SolveStats& stats) HWY_ATTR {
                                              return solve_triangle(batch, step, h_kick_by_mass, part, stats);
                                            });
  }
  return solve_groups<BaumgarteKernel>(batch, step, call, begin, end, scratch);
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(baumgarte_groups);

Batched<Baumgarte>::Batched(const System& sys, const Options& options, double h)
    : ExtrapolatingMethod(sys, options, h,
                          find_clusters(sys, options.in_lanes() ? ClusterLimits::cutting()
                                                                : ClusterLimits::none_in_lanes())) {
  const Damping damping = damping_named(options.damping);
  const std::vector<Gains> gains = choose_gains(options.choice(), damping, sys, h);
  setting_ = describe_baumgarte(options, gains, h);
  promised_ = promised_error_of(options, laws_of(gains, damping, options.gains, h));
  batches_.for_each([&](BaumgarteBatch& batch) {
    for (int k = 0; k < batch.lanes.bond_count(); ++k)
      batch.gains.push_back(gains[batch.lanes.bond(0, k, 0)]);
  });
}

void Batched<Baumgarte>::set_laws(const Push& push) {
  const double h = push.h;
  if (h == h_of_laws_ && push.starts() == laws_start_) return;
  h_of_laws_ = h;
  laws_start_ = push.starts();
  batches_.for_each([&](BaumgarteBatch& batch) {
    batch.laws.clear();
    for (const auto& [alpha, beta] : batch.gains) {
      const Propagator law(alpha * h, beta * h, Damping::kDiscrete);
      batch.laws.push_back(laws_start_ ? LaneLaw(law.from_rest, 0, h)
                                       : LaneLaw(law.trace, law.determinant, h));
    }
  });
}

SolveStats Batched<Baumgarte>::add_forces(const System&, const Push& push, State& s) {
  const SolveStats stats = solve(push, !push.starts(), s).beside(leftover_.add_forces(push, s));
  known_ = push.starts() ? 1 : std::min(known_ + 1, 3);
  return stats;
}

SolveStats Batched<Baumgarte>::again(const System&, const Push& push, State& s) {
  return solve(push, false, s).beside(leftover_.again(push, s));
}

SolveStats Batched<Baumgarte>::solve(const Push& push, bool shift, State& s) {
  set_laws(push);
  constexpr double kWeights[3][3] = {{1, 0, 0}, {2, -1, 0}, {3, -3, 1}};  // by order
  const auto& [last, first, second] = kWeights[std::clamp(known_ - 1, 0, options_.extrapolation)];
  const BaumgarteStep step{.h = push.h,
                           .h_kick = push.h_kick(),
                           .last = last,
                           .first = first,
                           .second = second,
                           .shift = shift,
                           .max_solves = options_.max_solves,
                           .turn = std::sqrt(2 * options_.tolerance),
                           .x = s.x.data(),
                           .v = s.v.data(),
                           .noise = push.noise ? push.noise->data() : nullptr,
                           .f = s.f.data()};
  return batches_.run(HWY_DYNAMIC_DISPATCH(baumgarte_groups), step);
}

}  // namespace taut
#endif
