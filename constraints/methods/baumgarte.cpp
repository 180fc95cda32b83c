#include "constraints/methods/baumgarte.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "constraints/bond_algebra.hpp"

namespace taut {
namespace {

constexpr int kSweepsOfASolve = 1000;  // where bonds are one-sided

Option tolerance_of_a_step(double& tolerance) {
  return {"tolerance",
          &tolerance,
          "relative bond error for which a step takes another solve",
          {.range = kTolerances}};
}
Option order_of_extrapolation(int& extrapolation) {
  return {
      "extrapolation", &extrapolation, "order in which λ is extrapolated", {.range = {.min = 0, .max = 2}}};
}
Option most_solves(int& max_solves) {
  return {"max_solves", &max_solves, "solves after which a step has failed", {.range = {.min = 1}}};
}

}  // namespace

std::vector<Option> Feedforward::Options::describe() {
  return {tolerance_of_a_step(tolerance), order_of_extrapolation(extrapolation), most_solves(max_solves)};
}

std::vector<Option> Baumgarte::Options::describe() {
  const bool named = !(alpha_per_ps && beta_per_ps);  // at least one of them
  const auto solved = [&](Option option) {
    option.about.counts = {sweeps == 0, "without method.sweeps"};
    return option;
  };
  Option most = solved(most_solves(max_solves));
  most.meaning =
      "solves after which a step has failed; where bonds are one-sided, each stands for 1000 sweeps";
  return {{"gains",
           &gains,
           "how α and β are chosen",
           {.counts = {named || gains == "numbers", "without both alpha_per_ps and beta_per_ps"},
            .words = gain_names()}},
          {"damping",
           &damping,
           "which form of the law: as differences, or as textbooks have it",
           {.counts = {!named || gains != "hoomd", "with other gains than \"hoomd\", whose drive is its own"},
            .words = damping_names()}},
          {"alpha_per_ps", &alpha_per_ps, "damping α, in place of the named one", {.unit = "1/ps"}},
          {"beta_per_ps", &beta_per_ps, "stiffness β, in place of the named one", {.unit = "1/ps"}},
          {"reduction",
           &reduction,
           "of an error a step, for gains = \"rattle\" or \"swept\" (see taut calibrate)",
           {.range = {.min = 0, .max = 1, .above_min = true, .below_max = true},
            .counts = {named && (gains == "rattle" || gains == "swept"),
                       "with method.gains = \"rattle\" or \"swept\""}}},
          {"stiffness",
           &stiffness,
           "of the real bond, for gains = \"physical\"",
           {.unit = "kJ/mol/nm²",
            .range = kPositive,
            .counts = {named && gains == "physical", "with method.gains = \"physical\""}}},
          {"sweeps",
           &sweeps,
           "more than 0: so many sweeps from the extrapolated λ in place of a factorization",
           {.range = {.min = 0}}},
          solved(tolerance_of_a_step(tolerance)),
          order_of_extrapolation(extrapolation),
          most};
}

Baumgarte::Baumgarte(const System& sys, const Options& options, double h)
    : options_(options),
      gains_(choose_gains(options.choice(), damping_named(options.damping), sys, h)),
      laws_(laws_of(gains_, damping_named(options.damping), options.gains, h)),
      h_of_laws_(h),
      two_sided_(sys.bond_count()),
      solver_(sys),
      r_(3, sys.all_bonds()),
      free_(r_),
      a_(r_),
      v_half_(r_),
      r_next_(r_),
      y_(3, sys.atoms()),
      target_(sys.all_bonds()),
      b_(sys.all_bonds()),
      lambda_(Eigen::VectorXd::Zero(sys.all_bonds())),
      before_(lambda_),
      before_that_(lambda_),
      corrects_(!(options.alpha_per_ps == 0 && options.beta_per_ps == 0)),
      promised_(promised_error_of(options, laws_)),
      by_sweeps_(options.sweeps > 0 || !sys.one_sided.empty()),
      setting_(describe_baumgarte(options, gains_, h)) {}

// λ_n from λ_{n−1}, 2λ_{n−1} − λ_{n−2} or 3λ_{n−1} − 3λ_{n−2} + λ_{n−3}, as far as they are known. One-sided bonds, whose λ
// jumps where they touch, take the first.
void Baumgarte::extrapolate() {
  const int order = std::min(options_.extrapolation, known_ - 1);
  for (Eigen::Index k = 0; k < lambda_.size(); ++k) {
    const double a = lambda_[k], b = before_[k], c = before_that_[k];
    before_that_[k] = b;
    before_[k] = a;
    if (k >= two_sided_) continue;
    if (order == 1) lambda_[k] = 2 * a - b;
    if (order == 2) lambda_[k] = 3 * (a - b) + c;
  }
  known_ = std::min(known_ + 1, 3);
}

SolveStats Baumgarte::add_forces(const System& sys, const Push& push, State& s) {
  if (push.starts())
    known_ = 1;
  else
    extrapolate();
  return again(sys, push, s);
}

SolveStats Baumgarte::again(const System& sys, const Push& push, State& s) {
  const SolveStats now = set_targets(sys, push, s);
  const auto solve_for_lambda = [&] {
    return by_sweeps_ ? solve_by_sweeps(sys, push, now) : solve(sys, push, now);
  };
  SolveStats stats = solve_for_lambda();
  if (!stats.converged() && known_ > 2 && options_.extrapolation > 0) {
    lambda_ = before_;  // the extrapolated λ led astray, as it does where bonds turn far in a step
    if (const SolveStats anew = solve_for_lambda(); anew.converged()) stats = anew;
  }
  add_constraint_force(sys, r_, lambda_, s.f);
  return stats;
}

// Sets what does not depend on λ: r, v_half, (M⁻¹F)_ij, r₊ without Jᵀλ, and τ without its drive. Returns the residuals at x.
SolveStats Baumgarte::set_targets(const System& sys, const Push& push, const State& s) {
  if (push.h != h_of_laws_) laws_ = laws_of(gains_, damping_named(options_.damping), options_.gains, push.h);
  h_of_laws_ = push.h;
  bond_vectors(sys, s.x, r_);
  differences(sys, s.v, v_half_);
  Residual now;
  for (int k = 0; k < sys.all_bonds(); ++k) {
    const double d = sys.bond(k).length;
    const int side = sys.side(k);
    const double sigma_now = sigma(r_.col(k), d);
    const double sigma_before = sigma(r_.col(k) - push.last_h() * v_half_.col(k), d);
    a_.col(k).setZero();
    sys.for_each_bearer(sys.bond(k),
                        [&](int a, double c) { a_.col(k) += c * push.acceleration(sys, s.f, a); });
    free_.col(k) = r_.col(k) + push.h * v_half_.col(k) + push.h_kick() * a_.col(k);
    now.see((side == 0 ? std::abs(sigma_now) : std::max(0.0, -side * sigma_now)) / (d * d), k);
    if (side == 0)
      target_[k] =
          push.starts() ? laws_[k].decay.from_rest * sigma_now : laws_[k].decay.next(sigma_now, sigma_before);
    else
      target_[k] = corrects_ ? 0 : 2 * sigma_now - sigma_before;
    if (!corrects_ && side * sigma_now > 0) r_.col(k).setZero();  // slack: left out
  }
  return {.max_residual = now.value, .worst_bond = now.bond, .failure = Failure::kNoConvergence};
}

// Returns σ₊ − τ of bond k, and sets r₊, for y = M⁻¹Jᵀλ.
double Baumgarte::miss(const System& sys, const Push& push, int k) {
  const Vec3 y_ij = sys.difference(sys.bond(k), y_);
  r_next_.col(k) = free_.col(k) + push.h_kick() * y_ij;
  double miss = sigma(r_next_.col(k), sys.bond(k).length) - target_[k];
  if (sys.side(k) == 0 && !laws_[k].drive.none()) {
    const Vec3 v = v_half_.col(k), a = a_.col(k) + y_ij;  // at the start v is of the full step
    miss -= push.starts() ? 0.5 * std::pow(push.h, 3) * (v + 0.25 * push.h * a).dot(a) : laws_[k].drive(v, a);
  }
  return miss;
}

SolveStats Baumgarte::solve(const System& sys, const Push& push, SolveStats stats) {
  bool left_out = false;  // a bond without a pivot, in the solve before
  int missing = -1;       // most, before the last solve
  while (!stats.converged() && stats.iterations < options_.max_solves) {
    y_.setZero();
    add_constraint_acceleration(sys, r_, lambda_, y_);
    Residual next;
    for (int k = 0; k < sys.bond_count(); ++k) {
      const double off = miss(sys, push, k);
      b_[k] = -off / push.h_kick();
      next.see(std::abs(off / r_next_.col(k).dot(r_.col(k))), k);
    }
    if (left_out && next.value <= options_.tolerance) {
      stats.failure = Failure::kNone;
      break;
    }
    missing = next.bond;
    solver_.factor(r_next_, r_);
    left_out = solver_.singular();
    if (has_turned() || !(next.value < 1e3)) {
      stats.worst_bond = left_out ? solver_.dependent_bonds().front() : next.bond;
      stats.failure = left_out ? Failure::kSingularOrTurned : Failure::kRanAway;
      return stats;
    }
    solver_.solve(b_);
    lambda_ += b_;
    ++stats.iterations;
    if (!left_out && is_near(next.value)) stats.failure = Failure::kNone;
  }
  if (is_driven() && !left_out) stats.failure = Failure::kNone;  // as textbooks stop, near or not
  if (stats.converged()) return stats;
  stats.worst_bond = left_out ? solver_.dependent_bonds().front() : missing;
  if (left_out) stats.failure = Failure::kSingularOrTurned;
  return stats;
}

// Whether what was off by `off` before a solve is within the tolerance after it. A drive is no part of A': with one what is
// off shrinks, but is not squared.
bool Baumgarte::is_near(double off) const {
  return is_driven() ? off <= std::max(1e-3 * options_.tolerance, 1e-14)
                     : 0.5 * off * off <= options_.tolerance;
}

bool Baumgarte::is_driven() const {
  return std::ranges::any_of(laws_, [](const Law& law) { return !law.drive.none(); });
}

// By 90° or more: a bond without a pivot.
bool Baumgarte::has_turned() const {
  return std::ranges::any_of(solver_.dependent_bonds(),
                             [&](int k) { return !(r_next_.col(k).dot(r_.col(k)) > 0); });
}

// Gauss–Seidel: each bond in its turn changes its own λ by −(σ₊ − τ)/(h² A'_kk), with all other λ as they are; λ of a
// one-sided bond keeps to its sign. Without method.sweeps this goes on until no bond misses more than the tolerance. Where
// r₊ · r is not positive, λ pulls the wrong way: a one-sided bond that is slack without λ is left alone there.
SolveStats Baumgarte::solve_by_sweeps(const System& sys, const Push& push, SolveStats stats) {
  const bool fixed = options_.sweeps > 0;
  const int most = fixed ? options_.sweeps : kSweepsOfASolve * options_.max_solves;
  y_.setZero();
  add_constraint_acceleration(sys, r_, lambda_, y_);
  bool near = false;
  Residual missed;  // before the corrections of the last sweep
  while (stats.iterations < most && !near) {
    missed = {};
    for (int k = 0; k < sys.all_bonds(); ++k) {
      if (r_.col(k).isZero(0)) continue;  // left out
      const double d = sys.bond(k).length;
      const int side = sys.side(k);
      const auto add = [&](double more) {
        add_constraint_acceleration(sys, k, more * r_.col(k), y_);
        lambda_[k] += more;
      };
      double off = miss(sys, push, k);
      if (side != 0 && lambda_[k] != 0 && r_next_.col(k).dot(r_.col(k)) <= 0) {
        add(-lambda_[k]);
        off = miss(sys, push, k);
      }
      if (side * off > 0 && lambda_[k] == 0) continue;  // slack
      const double along = r_next_.col(k).dot(r_.col(k));
      const double lambda = lambda_[k] - off / (push.h_kick() * sys.reduced_inv_mass(sys.bond(k)) * along);
      if (along <= 0 || !std::isfinite(lambda)) {
        stats.worst_bond = k;
        stats.failure = along <= 0 ? Failure::kTurned : Failure::kRanAway;
        return stats;
      }
      const double more = one_sided(side, lambda) - lambda_[k];
      if (more != 0) missed.see(std::abs(off) / (d * d), k);
      add(more);
    }
    ++stats.iterations;
    near = !fixed && missed.value <= options_.tolerance;
  }
  if (fixed || near)
    stats.failure = Failure::kNone;
  else
    stats.worst_bond = missed.bond;
  return stats;
}

std::string describe_baumgarte(const Baumgarte::Options& options, const std::vector<Gains>& gains, double h) {
  const std::string solved =
      options.sweeps > 0 ? fmt::format("{} sweep{} a step", options.sweeps, options.sweeps == 1 ? "" : "s")
                         : fmt::format("tolerance {:g}", options.tolerance);
  const std::string how = fmt::format("{}, λ extrapolated to order {}", solved, options.extrapolation);
  if (options.gains == "dead-beat" && options.damping == "discrete" && !options.alpha_per_ps &&
      !options.beta_per_ps)
    return how;
  if (options.gains == "numbers" && options.alpha_per_ps == 0 && options.beta_per_ps == 0)
    return "no correction";
  if (gains.empty()) return how;  // no bonds, or one-sided ones alone
  const auto [alpha, beta] = gains.front();
  const bool alike = std::ranges::all_of(
      gains, [&, alpha = alpha, beta = beta](const Gains& g) { return g.alpha == alpha && g.beta == beta; });
  return fmt::format("α {:.6g}/ps, β {:.6g}/ps (αh {:.4g}, βh {:.4g}){}, {} law, {}", alpha, beta, alpha * h,
                     beta * h, alike ? "" : " on the first bond", options.damping, how);
}

double promised_error_of(const Baumgarte::Options& options, const std::vector<Law>& laws) {
  double most = 1;
  for (const Law& law : laws) most = std::max(most, law.drive.none() ? law.decay.most_of_a_feed() : HUGE_VAL);
  if (options.sweeps > 0) most = HUGE_VAL;
  return most * (options.tolerance == Baumgarte::Options{}.tolerance ? 1e-5 : options.tolerance);
}

}  // namespace taut
