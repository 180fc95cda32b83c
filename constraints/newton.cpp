#include "constraints/newton.hpp"

#include <fmt/format.h>

#include "constraints/bond_algebra.hpp"

namespace taut {

Newton::Newton(const System& sys, const Options& options, double)
    : r_(3, sys.bond_count()),
      r_old_(3, sys.bond_count()),
      options_(options),
      solver_(sys),
      g_(Eigen::VectorXd::Zero(sys.bond_count())),
      dg_(g_),
      lambda_(g_) {}

SolveStats Newton::project_positions(const System& sys, double h, State& s) {
  for (int k = 0; k < sys.bond_count(); ++k) {
    const auto& [i, j, d] = sys.bonds[k];
    r_old_.col(k) = s.x.col(j) - s.x.col(i) - h * (s.v.col(j) - s.v.col(i));
  }
  if (!factored_) solver_.factor(r_old_);
  if (solver_.singular()) return {0, 0, solver_.dependent_bonds().front(), Failure::kSingular};

  g_ = 0.5 * h * h * lambda_;
  add_constraint_acceleration(sys, r_old_, g_, s.x);
  SolveStats stats{.failure = Failure::kNoConvergence};
  while (true) {
    Residual residual;
    for (int k = 0; k < sys.bond_count(); ++k) {
      const auto& [i, j, d] = sys.bonds[k];
      r_.col(k) = s.x.col(j) - s.x.col(i);
      dg_[k] = -sigma(r_.col(k), d);
      residual.see(std::abs(dg_[k]) / (d * d), k);
    }
    stats.max_residual = residual.value;
    stats.worst_bond = residual.bond;
    if (residual.value <= options_.tolerance) stats.failure = Failure::kNone;
    if (stats.converged() || stats.iterations == options_.max_iterations || !(residual.value < 1e3)) break;
    if (!solve(dg_, stats)) return stats;
    add_constraint_acceleration(sys, r_old_, dg_, s.x);
    g_ += dg_;
    ++stats.iterations;
  }
  dg_ = g_ / h;
  add_constraint_acceleration(sys, r_old_, dg_, s.v);
  lambda_ = 2 / (h * h) * g_;
  return stats;
}

SolveStats Newton::project_velocities(const System& sys, double h, State& s) {
  differences(sys, s.x, r_);
  solver_.factor(r_);
  factored_ = true;
  if (solver_.singular()) return {0, 0, solver_.dependent_bonds().front(), Failure::kSingular};
  for (int k = 0; k < sys.bond_count(); ++k) {
    const auto& [i, j, d] = sys.bonds[k];
    g_[k] = -r_.col(k).dot(s.v.col(j) - s.v.col(i));
  }
  solver_.solve(g_);
  add_constraint_acceleration(sys, r_, g_, s.v);
  lambda_ = 2 / h * g_;
  return {1};
}

std::string Newton::setting() const {
  return fmt::format("tolerance {:g}", options_.tolerance);
}

}  // namespace taut
