#include "constraints/methods/feedforward.hpp"

#include <fmt/format.h>

#include "constraints/bond_algebra.hpp"

namespace taut {

Feedforward::Feedforward(const System& sys, const Options& options, double)
    : options_(options),
      solver_(sys),
      r_(3, sys.bond_count()),
      r_next_(3, sys.bond_count()),
      y_(3, sys.atoms()),
      b_(sys.bond_count()),
      lambda_(Eigen::VectorXd::Zero(sys.bond_count())),
      before_(lambda_),
      before_that_(lambda_) {}

// λ_n from λ_{n−1}, 2λ_{n−1} − λ_{n−2} or 3λ_{n−1} − 3λ_{n−2} + λ_{n−3}, as far as they are known.
void Feedforward::extrapolate() {
  const int order = std::min(options_.extrapolation, known_ - 1);
  for (Eigen::Index k = 0; k < lambda_.size(); ++k) {
    const double a = lambda_[k], b = before_[k], c = before_that_[k];
    before_that_[k] = b;
    before_[k] = a;
    if (order == 1) lambda_[k] = 2 * a - b;
    if (order == 2) lambda_[k] = 3 * (a - b) + c;
  }
  known_ = std::min(known_ + 1, 3);
}

SolveStats Feedforward::add_forces(const System& sys, const Push& push, State& s) {
  if (push.starts())
    known_ = 1;
  else
    extrapolate();
  return again(sys, push, s);
}

SolveStats Feedforward::again(const System& sys, const Push& push, State& s) {
  const SolveStats stats = solve(sys, push, s);
  add_constraint_force(sys, r_, lambda_, s.f);
  return stats;
}

SolveStats Feedforward::solve(const System& sys, const Push& push, const State& s) {
  const double drift = push.drift();
  differences(sys, s.x, r_);
  SolveStats stats{.failure = Failure::kNoConvergence};
  while (!stats.converged() && stats.iterations < options_.max_solves) {
    y_.setZero();
    add_constraint_acceleration(sys, r_, lambda_, y_);
    Residual now, next;
    for (int k = 0; k < sys.bond_count(); ++k) {
      const auto& [i, j, d] = sys.bonds[k];
      const Vec3 a_ij =
          sys.inv_mass[j] * push.force(s.f, j) - sys.inv_mass[i] * push.force(s.f, i) + y_.col(j) - y_.col(i);
      r_next_.col(k) = r_.col(k) + push.h * (s.v.col(j) - s.v.col(i)) + drift * a_ij;
      const double sigma_next = sigma(r_next_.col(k), d);
      b_[k] = -sigma_next / drift;
      now.see(std::abs(sigma(r_.col(k), d)) / (d * d), k);
      next.see(std::abs(sigma_next / r_next_.col(k).dot(r_.col(k))), k);
    }
    stats.max_residual = now.value;
    stats.worst_bond = now.bond;
    solver_.factor(r_next_, r_);
    if (solver_.singular() || !(next.value < 1e3)) {
      stats.worst_bond = solver_.singular() ? solver_.dependent_bonds().front() : next.bond;
      stats.failure = solver_.singular() ? Failure::kSingularOrTurned : Failure::kRanAway;
      return stats;
    }
    solver_.solve(b_);
    lambda_ += b_;
    ++stats.iterations;
    if (0.5 * next.value * next.value <= options_.tolerance) stats.failure = Failure::kNone;
  }
  return stats;
}

std::string Feedforward::setting() const {
  return fmt::format("tolerance {:g}, λ extrapolated to order {}", options_.tolerance,
                     options_.extrapolation);
}

}  // namespace taut
