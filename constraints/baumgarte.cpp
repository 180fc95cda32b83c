#include "constraints/baumgarte.hpp"

#include <fmt/format.h>

#include "constraints/bond_algebra.hpp"

namespace taut {

Baumgarte::Baumgarte(const System& sys, const Options& options, double h)
    : damping_(damping_named(options.damping)),
      gains_(choose_gains(options.choice(), damping_, sys, h)),
      passes_(options.passes),
      sweeps_(options.sweeps),
      solver_(sys),
      r_(3, sys.bond_count()),
      w_ij_(3, sys.bond_count()),
      a_ij_(3, sys.bond_count()),
      y_(3, sys.atoms()),
      known_(sys.bond_count()),
      wanted_(sys.bond_count()),
      lambda_(Eigen::VectorXd::Zero(sys.bond_count())),
      before_(lambda_),
      setting_(describe_baumgarte(options, gains_, h)) {}

// λ* = λ₁ + (λ₁ − λ₂)/3; λ₁ while there is no λ₂.
void Baumgarte::guess_lambda() {
  for (Eigen::Index k = 0; k < lambda_.size(); ++k) {
    const double last = lambda_[k];
    if (steps_ >= 2) lambda_[k] += (last - before_[k]) / 3;
    before_[k] = last;
  }
  if (steps_ < 2) ++steps_;
}

// A λ = wanted from where λ and y = M⁻¹Jᵀλ are: bond k is off by wanted_k − r_k·y_ij, and λ_k takes that over
// A_kk.
void Baumgarte::solve_by_sweeps(const System& sys) {
  for (int sweep = 0; sweep < sweeps_; ++sweep)
    for (int k = 0; k < sys.bond_count(); ++k) {
      const auto& [i, j, d] = sys.bonds[k];
      const double off = wanted_[k] - r_.col(k).dot(y_.col(j) - y_.col(i));
      const double more = off / ((sys.inv_mass[i] + sys.inv_mass[j]) * r_.col(k).squaredNorm());
      y_.col(i) -= sys.inv_mass[i] * more * r_.col(k);
      y_.col(j) += sys.inv_mass[j] * more * r_.col(k);
      lambda_[k] += more;
    }
}

SolveStats Baumgarte::add_forces(const System& sys, double h, State& s) {
  differences(sys, s.x, r_);
  Residual residual;
  for (int k = 0; k < sys.bond_count(); ++k) {
    const auto& [i, j, d] = sys.bonds[k];
    const auto& [alpha, beta] = gains_[k];
    a_ij_.col(k) = sys.inv_mass[j] * s.f.col(j) - sys.inv_mass[i] * s.f.col(i);
    const Vec3 v_half = s.v.col(j) - s.v.col(i);
    w_ij_.col(k) = v_half + 0.5 * h * a_ij_.col(k);
    const double rate = r_.col(k).dot(damping_ == Damping::kLagged ? v_half : Vec3(w_ij_.col(k)));
    const double sigma_k = sigma(r_.col(k), d);
    known_[k] = r_.col(k).dot(a_ij_.col(k)) + 2 * alpha * rate + beta * beta * sigma_k;
    residual.see(std::abs(sigma_k) / (d * d), k);
  }
  if (sweeps_ == 0) {
    solver_.factor(r_);
    if (solver_.singular()) return {0, residual.value, solver_.dependent_bonds().front(), Failure::kSingular};
  }

  guess_lambda();
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
    if (sweeps_ > 0) {
      solve_by_sweeps(sys);
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
