#include "constraints/methods/newton.hpp"

#include <fmt/format.h>

#include "constraints/bond_algebra.hpp"

namespace taut {

Newton::Newton(const System& sys, const Options& options, double)
    : r_(3, sys.all_bonds()),
      r_old_(3, sys.all_bonds()),
      options_(options),
      solver_(sys),
      g_(Eigen::VectorXd::Zero(sys.all_bonds())),
      dg_(g_),
      lambda_(g_) {
  if (!sys.one_sided.empty()) active_set_.emplace(sys);
}

SolveStats Newton::project_positions(const System& sys, double h, State& s) {
  for (int k = 0; k < sys.all_bonds(); ++k) {
    const auto& [i, j, d] = sys.bond(k);
    r_old_.col(k) = s.x.col(j) - s.x.col(i) - h * (s.v.col(j) - s.v.col(i));
  }
  if (!active_set_ && !factored_) solver_.factor(r_old_);
  if (solver_.singular()) return {0, 0, solver_.dependent_bonds().front(), Failure::kSingular};

  g_ = 0.5 * h * h * lambda_;
  add_constraint_acceleration(sys, r_old_, g_, s.x);
  SolveStats stats{.failure = Failure::kNoConvergence};
  while (true) {
    Residual residual;
    for (int k = 0; k < sys.all_bonds(); ++k) {
      const auto& [i, j, d] = sys.bond(k);
      r_.col(k) = s.x.col(j) - s.x.col(i);
      dg_[k] = -sigma(r_.col(k), d);
      if (sys.side(k) * dg_[k] < 0 && g_[k] == 0) continue;  // slack
      residual.see(std::abs(dg_[k]) / (d * d), k);
    }
    stats.max_residual = residual.value;
    stats.worst_bond = residual.bond;
    if (residual.value <= options_.tolerance) stats.failure = Failure::kNone;
    if (stats.converged() || stats.iterations == options_.max_iterations || !(residual.value < 1e3)) break;
    if (!(active_set_ ? solve_one_sided(sys, r_old_, stats) : solve(dg_, stats))) return stats;
    add_constraint_acceleration(sys, r_old_, dg_, s.x);
    g_ += dg_;
    ++stats.iterations;
  }
  dg_ = g_ / h;
  add_constraint_acceleration(sys, r_old_, dg_, s.v);
  lambda_ = 2 / (h * h) * g_;
  return stats;
}

// Replaces dg_ = −σ by the change Δg of the multipliers of all bonds that act: A(g + Δg) = Ag − σ, with every
// g + Δg of the sign that its one-sided bond allows.
bool Newton::solve_one_sided(const System& sys, const Vectors& r, SolveStats& stats) {
  y_.setZero(3, sys.atoms());
  add_constraint_acceleration(sys, r, g_, y_);
  for (int k = 0; k < sys.all_bonds(); ++k) {
    const auto& [i, j, d] = sys.bond(k);
    dg_[k] += r.col(k).dot(y_.col(j) - y_.col(i));
  }
  total_ = g_;
  stats.failure = active_set_->solve(sys, r, dg_, total_);
  stats.worst_bond = active_set_->blamed();
  dg_ = total_ - g_;
  if (!stats.converged()) return false;
  stats.failure = Failure::kNoConvergence;  // until the iteration has converged
  return true;
}

SolveStats Newton::project_velocities(const System& sys, double h, State& s) {
  differences(sys, s.x, r_);
  if (active_set_) return project_one_sided_velocities(sys, h, s);
  solver_.factor(r_);
  factored_ = true;
  if (solver_.singular()) return {0, 0, solver_.dependent_bonds().front(), Failure::kSingular};
  for (int k = 0; k < sys.all_bonds(); ++k) {
    const auto& [i, j, d] = sys.bond(k);
    g_[k] = -r_.col(k).dot(s.v.col(j) - s.v.col(i));
  }
  solver_.solve(g_);
  add_constraint_acceleration(sys, r_, g_, s.v);
  lambda_ = 2 / h * g_;
  return {1};
}

// The same with those one-sided bonds that act on the positions.
SolveStats Newton::project_one_sided_velocities(const System& sys, double h, State& s) {
  for (int k = 0; k < sys.all_bonds(); ++k) {
    const auto& [i, j, d] = sys.bond(k);
    if (sys.side(k) != 0 && lambda_[k] == 0) r_.col(k).setZero();
    dg_[k] = -r_.col(k).dot(s.v.col(j) - s.v.col(i));
  }
  g_ = 0.5 * h * lambda_;
  SolveStats stats{.iterations = 1, .failure = active_set_->solve(sys, r_, dg_, g_)};
  stats.worst_bond = active_set_->blamed();
  if (!stats.converged()) return stats;
  add_constraint_acceleration(sys, r_, g_, s.v);
  lambda_ = 2 / h * g_;
  return stats;
}

std::string Newton::setting() const {
  return fmt::format("tolerance {:g}", options_.tolerance);
}

}  // namespace taut
