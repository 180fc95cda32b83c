#include "constraints/methods/baumgarte.hpp"

#include <fmt/format.h>

#include "constraints/active_set.hpp"
#include "constraints/bond_algebra.hpp"

namespace taut {
namespace {

constexpr int kPassesOfATouch = 3;  // no previous λ predicts a touch; a pass gains a factor hv/d

}  // namespace

Baumgarte::Baumgarte(const System& sys, const Options& options, double h)
    : damping_(damping_named(options.damping)),
      gains_(choose_gains(options.choice(), damping_, sys, h)),
      guesses_(guesses_of(sys, damping_)),
      passes_(options.passes),
      sweeps_(options.sweeps),
      solver_(sys),
      r_(3, sys.all_bonds()),
      w_ij_(3, sys.all_bonds()),
      a_ij_(3, sys.all_bonds()),
      y_(3, sys.atoms()),
      known_(sys.all_bonds()),
      wanted_(sys.all_bonds()),
      lambda_(Eigen::VectorXd::Zero(sys.all_bonds())),
      before_(lambda_),
      before_that_(lambda_),
      setting_(describe_baumgarte(options, gains_, h)) {
  if (sys.one_sided.empty()) return;
  active_set_.emplace(sys);
  corrects_ = !(options.alpha_per_ps == 0 && options.beta_per_ps == 0);
  if (corrects_) passes_ = std::max(passes_, kPassesOfATouch);
}

std::vector<Guess> guesses_of(const System& sys, Damping damping) {
  std::vector<Guess> guesses(sys.all_bonds());  // one-sided bonds take λ₁ alone
  std::fill_n(guesses.begin(), sys.bond_count(), kThird);
  if (damping != Damping::kDiscrete) return guesses;
  const std::vector<bool> small = meets_all_others(sys);
  for (int k = 0; k < sys.bond_count(); ++k)
    if (small[k]) guesses[k] = kOfSmallClusters;
  return guesses;
}

void Baumgarte::guess_lambda() {
  for (Eigen::Index k = 0; k < lambda_.size(); ++k) {
    const auto [first, second] = limit_to_known(guesses_[k], steps_);
    const double guess =
        lambda_[k] + first * (lambda_[k] - before_[k]) + second * (before_[k] - before_that_[k]);
    before_that_[k] = before_[k];
    before_[k] = lambda_[k];
    lambda_[k] = guess;
  }
  steps_ = std::min(steps_ + 1, 3);
}

// Gauss–Seidel sweeps on A λ = wanted, from the present λ and y = M⁻¹Jᵀλ: the residual of bond k is
// wanted_k − r_k·y_ij, and λ_k changes by it over A_kk.
void Baumgarte::solve_by_sweeps(const System& sys) {
  for (int sweep = 0; sweep < sweeps_; ++sweep)
    for (int k = 0; k < sys.all_bonds(); ++k) {
      const auto& [i, j, d] = sys.bond(k);
      if (sys.side(k) != 0 && r_.col(k).isZero(0)) continue;  // left out
      const double off = wanted_[k] - r_.col(k).dot(y_.col(j) - y_.col(i));
      double more = off / ((sys.inv_mass[i] + sys.inv_mass[j]) * r_.col(k).squaredNorm());
      if (sys.side(k) != 0) more = one_sided(sys.side(k), lambda_[k] + more) - lambda_[k];
      y_.col(i) -= sys.inv_mass[i] * more * r_.col(k);
      y_.col(j) += sys.inv_mass[j] * more * r_.col(k);
      lambda_[k] += more;
    }
}

// Sets the λ-independent terms of one-sided bond k: w_ij_ = Δ = hv + drift·a, the displacement of the coming
// step, and known_ = σ + r·Δ. Without correction a slack bond is left out (r = 0).
void Baumgarte::look_ahead(const System& sys, const Push& push, const State& s, int k) {
  const auto& [i, j, d] = sys.bond(k);
  const double sigma_k = sigma(r_.col(k), d);
  a_ij_.col(k) = sys.inv_mass[j] * push.force(s.f, j) - sys.inv_mass[i] * push.force(s.f, i);
  w_ij_.col(k) = s.v.col(j) - s.v.col(i);
  if (corrects_) {
    w_ij_.col(k) = push.h * w_ij_.col(k) + push.drift() * a_ij_.col(k);
    known_[k] = sigma_k + r_.col(k).dot(w_ij_.col(k));
  } else {
    w_ij_.col(k) += 0.5 * push.last_h() * a_ij_.col(k);
    if (sys.side(k) * sigma_k > 0) r_.col(k).setZero();
    known_[k] = r_.col(k).dot(a_ij_.col(k));
  }
}

// Sets the right-hand side of one-sided bond k: s(σ + r·(Δ + τy) + ½|Δ + τy*|²) ≥ 0, where y = M⁻¹Jᵀλ and
// τ = push.drift(); without correction s(r·(a + y) + |v*|²) ≥ 0.
void Baumgarte::want_one_sided(const System& sys, const Push& push, int k) {
  const auto& [i, j, d] = sys.bond(k);
  const Vec3 y_ij = y_.col(j) - y_.col(i);
  if (corrects_)
    wanted_[k] = -(known_[k] + 0.5 * (w_ij_.col(k) + push.drift() * y_ij).squaredNorm()) / push.drift();
  else
    wanted_[k] =
        r_.col(k).isZero(0) ? 0 : -(known_[k] + (w_ij_.col(k) + 0.5 * push.last_h() * y_ij).squaredNorm());
}

SolveStats Baumgarte::add_forces(const System& sys, const Push& push, State& s) {
  guess_lambda();
  return again(sys, push, s);
}

SolveStats Baumgarte::again(const System& sys, const Push& push, State& s) {
  const double h = push.last_h();  // at the start there is no motion before x to take differences with
  differences(sys, s.x, r_);
  Residual residual;
  for (int k = 0; k < sys.bond_count(); ++k) {
    const auto& [i, j, d] = sys.bonds[k];
    const auto& [alpha, beta] = gains_[k];
    a_ij_.col(k) = sys.inv_mass[j] * push.force(s.f, j) - sys.inv_mass[i] * push.force(s.f, i);
    const Vec3 v_half = s.v.col(j) - s.v.col(i);
    w_ij_.col(k) = v_half + 0.5 * h * a_ij_.col(k);
    const double rate = r_.col(k).dot(damping_ == Damping::kLagged ? v_half : Vec3(w_ij_.col(k)));
    const double sigma_k = sigma(r_.col(k), d);
    known_[k] = r_.col(k).dot(a_ij_.col(k)) + 2 * alpha * rate + beta * beta * sigma_k;
    residual.see(std::abs(sigma_k) / (d * d), k);
  }
  for (int k = sys.bond_count(); k < sys.all_bonds(); ++k) {
    const auto& [i, j, d] = sys.bond(k);
    residual.see(std::max(0.0, -sys.side(k) * sigma(r_.col(k), d)) / (d * d), k);
    look_ahead(sys, push, s, k);
  }
  if (sweeps_ == 0 && !active_set_) {
    solver_.factor(r_);
    if (solver_.singular()) return {0, residual.value, solver_.dependent_bonds().front(), Failure::kSingular};
  }

  for (int pass = 0; pass < passes_; ++pass) {
    y_.setZero();
    add_constraint_acceleration(sys, r_, lambda_, y_);
    for (int k = 0; k < sys.bond_count(); ++k) {
      const auto& [i, j, d] = sys.bonds[k];
      const double alpha = gains_[k].alpha;
      const Vec3 y_ij = y_.col(j) - y_.col(i);
      const Vec3 v_ij = w_ij_.col(k) + 0.5 * h * y_ij;
      double rest = known_[k] + v_ij.squaredNorm();
      const Vec3 a_ij = a_ij_.col(k) + y_ij;
      if (damping_ == Damping::kDiscrete || damping_ == Damping::kCentred)
        rest += alpha * h * h * v_ij.dot(a_ij);
      if (damping_ == Damping::kDiscrete) rest += 0.25 * h * h * a_ij.squaredNorm();
      wanted_[k] = -rest / (damping_ == Damping::kLagged ? 1 : 1 + alpha * h);
    }
    for (int k = sys.bond_count(); k < sys.all_bonds(); ++k) want_one_sided(sys, push, k);
    if (sweeps_ > 0) {
      solve_by_sweeps(sys);
    } else if (active_set_) {
      const Failure failure = active_set_->solve(sys, r_, wanted_, lambda_);
      if (failure != Failure::kNone) return {pass, residual.value, active_set_->blamed(), failure};
    } else {
      lambda_ = wanted_;
      solver_.solve(lambda_);
    }
  }
  add_constraint_force(sys, r_, lambda_, s.f);
  return {sweeps_ > 0 ? passes_ * sweeps_ : passes_, residual.value, residual.bond};
}

std::string describe_baumgarte(const Baumgarte::Options& options, const std::vector<Gains>& gains, double h) {
  const auto& [passes, sweeps] = std::tie(options.passes, options.sweeps);
  if (options.gains == "numbers" && options.alpha_per_ps == 0 && options.beta_per_ps == 0 && passes == 1 &&
      sweeps == 0)
    return "no correction";
  if (gains.empty()) return "no bonds";
  const auto [alpha, beta] = gains.front();
  const int count = sweeps > 0 ? passes * sweeps : passes;
  const bool alike = std::all_of(gains.begin(), gains.end(), [&, alpha = alpha, beta = beta](const Gains& g) {
    return g.alpha == alpha && g.beta == beta;
  });
  return fmt::format("α {:.6g}/ps, β {:.6g}/ps (αh {:.4g}, βh {:.4g}){}, {} damping, {} {}{} a step", alpha,
                     beta, alpha * h, beta * h, alike ? "" : " on the first bond", options.damping, count,
                     sweeps > 0 ? "sweep" : "solve", count == 1 ? "" : "s");
}

}  // namespace taut
