#include "constraints/batch/batched_baumgarte.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "constraints/batch/batched_baumgarte.cpp"
#include <hwy/foreach_target.h>

#include "constraints/batch/past_lambda-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

struct BaumgarteRows {
  double *x, *v, *f;  // 3 × atoms
  double* r;          // 3 × bonds

  HWY_INLINE BaumgarteRows(const auto shape, Scratch& scratch)
      : x(scratch.take(3 * shape.atoms())),
        v(scratch.take(3 * shape.atoms())),
        f(scratch.take(3 * shape.atoms())),
        r(scratch.take(3 * shape.size())) {}
};

// f += Jᵀλ*; λ becomes λ*, and what it was is past (with `shift`: else λ* is λ). r is found on the way.
template <class Shape>
HWY_INLINE void apply_guess(const Shape shape, const Guess& guess, bool shift, const PastLambda past,
                            const BaumgarteRows rows) {
  const V first = broadcast(guess.first), second = broadcast(guess.second);
  const auto foretold = [&](V one, V two, V three) HWY_ATTR {
    return hn::MulAdd(second, hn::Sub(two, three), hn::MulAdd(first, hn::Sub(one, two), one));
  };
  for (int k = 0; k < shape.size(); ++k) {
    const V3 r = difference(shape, k, rows.x);
    store3(r, rows.r + 3 * k * kLanes);
    const V guessed = shift ? past.shift(k, foretold) : load(past.lambda + k * kLanes);
    add_constraint_force(shape, k, guessed, r, rows.f);
  }
}

// Sets b, the right-hand side for λ − λ*; the first time also the diagonal of A and the residuals.
template <bool kFirst, class Shape>
HWY_INLINE void right_hand_side(const Shape shape, const BaumgarteCoefficients* coefficients, double h,
                                const BaumgarteRows rows, const Equations& eq, Worst& worst) {
  const V half_h = broadcast(0.5 * h);
  for (int k = 0; k < shape.solved(); ++k) {
    const LaneBond& bond = shape.bonds[k];
    const BaumgarteCoefficients& c = coefficients[k];
    const V3 r = load3(rows.r + 3 * k * kLanes);
    const V3 a = neg_mul_add(broadcast(bond.inv_mass_i), load3(rows.f + shape.i(k)),
                             broadcast(bond.inv_mass_j) * load3(rows.f + shape.j(k)));
    const V3 w = mul_add(half_h, a, difference(shape, k, rows.v));
    const V rr = dot(r, r), twice_sigma = hn::Sub(rr, broadcast(bond.length2));
    V b = hn::Mul(broadcast(c.rate_a), dot(r, a));
    b = hn::MulAdd(broadcast(c.rate_v), dot(r, w), b);
    b = hn::MulAdd(broadcast(c.square_v), dot(w, w), b);
    b = hn::MulAdd(broadcast(c.cross), dot(w, a), b);
    b = hn::MulAdd(broadcast(c.square_a), dot(a, a), b);
    b = hn::MulAdd(broadcast(c.sigma), twice_sigma, b);
    store(hn::Neg(b), eq.b + k * kLanes);
    if constexpr (kFirst) {
      worst.include(bond, twice_sigma);
      store(hn::Mul(broadcast(bond.reduced_inv_mass), rr), eq.A.d + k * kLanes);
    }
  }
}

// λ += Δλ, f += JᵀΔλ
template <class Shape>
HWY_INLINE void apply_change(const Shape shape, const double* b, double* lambda, const BaumgarteRows rows) {
  for (int k = 0; k < shape.size(); ++k) {
    const V change = load(b + k * kLanes);
    store(hn::Add(load(lambda + k * kLanes), change), lambda + k * kLanes);
    add_constraint_force(shape, k, change, load3(rows.r + 3 * k * kLanes), rows.f);
  }
}

// kNoise: a thermostat's random force acts besides f. It is known when compiled, because a branch would keep
// the rows of small clusters out of registers.
template <class Shape, bool kNoise>
struct BaumgarteKernel {
  static constexpr bool kOnceMostly = true;
  const Shape shape;
  const BaumgarteStep& step;
  const Part& part;
  const BaumgarteCoefficients* coefficients;
  const Guess wanted;
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
        coefficients(batch.coefficients.data()),
        wanted(batch.guess),
        past(batch, part),
        eq(equations(shape, scratch)),
        rows(shape, scratch),
        x(rows.x) {}

  HWY_INLINE SolveNext next(int solves) const {
    return solves + 1 < step.passes ? SolveNext::kSolve : SolveNext::kLastSolve;
  }
  HWY_INLINE SolveNext start(SolveStats&) {
    gather(part, shape.atoms(), step.x, rows.x);
    if constexpr (kNoise)
      gather_sum(part, shape.atoms(), step.f, step.noise, rows.v, rows.f);
    else
      gather(part, shape.atoms(), step.f, rows.f);
    gather(part, shape.atoms(), step.v, rows.v);
    apply_guess(shape, limit_to_known(wanted, step.known), step.shift, past, rows);
    right_hand_side<true>(shape, coefficients, step.h, rows, eq, worst);
    return next(0);
  }
  HWY_INLINE bool forward(int solves, SolveStats& stats) {
    if (solves > 0) {
      substitute_forward(shape, part, eq);
      return true;
    }
    return factor(shape, part, eq, rows.r, stats);
  }
  HWY_INLINE void back() { substitute_back(shape, eq.A.inv_d, eq.A.l, eq.b); }
  HWY_INLINE SolveNext apply(SolveNext last, int solves, SolveStats&) {
    apply_change(shape, eq.b, past.lambda, rows);
    if (last == SolveNext::kLastSolve) return SolveNext::kEnd;
    right_hand_side<false>(shape, coefficients, step.h, rows, eq, worst);
    return next(solves);
  }
  HWY_INLINE void end(SolveStats& stats) {
    if constexpr (kNoise) forces_without_noise(shape, part, step.f, past.lambda, rows.r, rows.f);
    scatter(shape, part, rows.f, step.f);
    if (worst.within(stats.max_residual)) return;
    find_residuals(part.batch, rows.x, eq.b);
    record_largest(part, eq.b, stats);
  }
};

template <class Shape>
using QuietKernel = BaumgarteKernel<Shape, false>;
template <class Shape>
using NoisyKernel = BaumgarteKernel<Shape, true>;

SolveStats baumgarte_groups(BaumgarteBatch& batch, const BaumgarteStep& step, const SolveCall& call,
                            int begin, int end, const Scratch& scratch) {
  return step.noise ? solve_groups<NoisyKernel>(batch, step, call, begin, end, scratch)
                    : solve_groups<QuietKernel>(batch, step, call, begin, end, scratch);
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(baumgarte_groups);

Batched<Baumgarte>::Batched(const System& sys, const Options& options, double h)
    : ExtrapolatingMethod(
          sys, options, h,
          find_clusters(sys, options.sweeps > 0 ? ClusterLimits{0, 0} : ClusterLimits::cutting())),
      damping_(damping_named(options.damping)) {
  const std::vector<Gains> gains = choose_gains(options.choice(), damping_, sys, h);
  const std::vector<Guess> guesses = guesses_of(sys, damping_);
  setting_ = describe_baumgarte(options, gains, h);
  batches_.for_each([&](BaumgarteBatch& batch) {
    for (int k = 0; k < batch.lanes.bond_count(); ++k)
      batch.gains.push_back(gains[batch.lanes.bond(0, k, 0)]);
    batch.coefficients.resize(batch.gains.size());
    batch.guess = guesses[batch.lanes.bond(0, 0, 0)];
  });
}

void Batched<Baumgarte>::set_coefficients(double h) {
  if (h == h_of_coefficients_) return;
  h_of_coefficients_ = h;
  const bool lagged = damping_ == Damping::kLagged, discrete = damping_ == Damping::kDiscrete;
  const bool centred = discrete || damping_ == Damping::kCentred;
  batches_.for_each([&](BaumgarteBatch& batch) {
    for (std::size_t k = 0; k < batch.gains.size(); ++k) {
      const auto [alpha, beta] = batch.gains[k];
      const double q = lagged ? 1 : 1 + alpha * h;
      batch.coefficients[k] = {.rate_a = (lagged ? 1 - alpha * h : 1) / q,
                               .rate_v = 2 * alpha / q,
                               .square_v = 1 / q,
                               .cross = centred ? alpha * h * h / q : 0,
                               .square_a = discrete ? 0.25 * h * h / q : 0,
                               .sigma = 0.5 * beta * beta / q};
    }
  });
}

SolveStats Batched<Baumgarte>::add_forces(const System&, const Push& push, State& s) {
  const SolveStats stats = solve(push, true, s).beside(leftover_.add_forces(push, s));
  known_ = std::min(known_ + 1, 3);
  return stats;
}

SolveStats Batched<Baumgarte>::again(const System&, const Push& push, State& s) {
  return solve(push, false, s).beside(leftover_.again(push, s));
}

SolveStats Batched<Baumgarte>::solve(const Push& push, bool shift, State& s) {
  set_coefficients(push.last_h());
  const BaumgarteStep step{.h = push.last_h(),
                           .known = known_,
                           .shift = shift,
                           .passes = options_.passes,
                           .x = s.x.data(),
                           .v = s.v.data(),
                           .noise = push.noise ? push.noise->data() : nullptr,
                           .f = s.f.data()};
  return batches_.run(HWY_DYNAMIC_DISPATCH(baumgarte_groups), step);
}

}  // namespace taut
#endif
