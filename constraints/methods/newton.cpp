#include "constraints/methods/newton.hpp"

#include <fmt/format.h>

#include <limits>

#include "constraints/bond_algebra.hpp"

namespace taut {

Newton::Newton(const System& sys, const Options& options, double)
    : r_(3, sys.bond_count()),
      r_old_(r_),
      options_(options),
      solver_(sys),
      g_(Eigen::VectorXd::Zero(sys.bond_count())),
      dg_(g_),
      lambda_(g_) {}

SolveStats Newton::project_positions(const System& sys, double h, State& s) {
  for (int k = 0; k < sys.bond_count(); ++k) {
    r_old_.col(k) = sys.along(sys.bonds[k], s.x) - h * sys.difference(sys.bonds[k], s.v);
  }
  if (!factored_) solver_.factor(r_old_);

  g_ = 0.5 * h * h * lambda_;
  add_constraint_acceleration(sys, r_old_, g_, s.x);
  SolveStats stats{.failure = Failure::kNoConvergence};
  bool exactly = false;  // then exact_ is of this step
  for (double before = std::numeric_limits<double>::infinity();;) {
    Residual residual;
    for (int k = 0; k < sys.bond_count(); ++k) {
      const double d = sys.bonds[k].length;
      r_.col(k) = sys.along(sys.bonds[k], s.x);
      dg_[k] = -sigma(r_.col(k), d);
      residual.see(std::abs(dg_[k]) / (d * d), k);
    }
    stats.max_residual = residual.value;
    stats.worst_bond = residual.bond;
    if (residual.value <= options_.tolerance) stats.failure = Failure::kNone;
    if (stats.converged() || stats.iterations == options_.max_iterations || !(residual.value < 1e3)) break;
    exactly |= residual.value > before;
    before = residual.value;
    if (!(exactly ? solve_exactly(dg_, stats) : solve(dg_, stats))) return stats;
    add_constraint_acceleration(sys, r_old_, dg_, s.x);
    g_ += dg_;
    ++stats.iterations;
  }
  if (!stats.converged()) explain_by_pivots(exactly, stats);
  dg_ = g_ / h;
  add_constraint_acceleration(sys, r_old_, dg_, s.v);
  lambda_ = 2 / (h * h) * g_;
  return stats;
}

bool Newton::solve_exactly(Eigen::VectorXd& b, SolveStats& stats) {
  if (!exact_) exact_ = solver_;
  exact_->factor(r_, r_old_);
  for (const int k : exact_->dependent_bonds())
    if (!(r_.col(k).dot(r_old_.col(k)) > 0)) {
      stats.worst_bond = k;
      stats.failure = Failure::kSingularOrTurned;
      return false;
    }
  exact_->solve(b);
  return true;
}

// Why the iteration did not converge: where bonds were left out for want of a pivot, for that.
void Newton::explain_by_pivots(bool exactly, SolveStats& stats) const {
  const bool turned = exactly && exact_->singular();
  if (!turned && !solver_.singular()) return;
  stats.worst_bond = (turned ? *exact_ : solver_).dependent_bonds().front();
  stats.failure = turned ? Failure::kSingularOrTurned : Failure::kSingular;
}

SolveStats Newton::project_velocities(const System& sys, double h, State& s) {
  bond_vectors(sys, s.x, r_);
  solver_.factor(r_);
  factored_ = true;
  const auto rate = [&](int k) { return r_.col(k).dot(sys.difference(sys.bonds[k], s.v)); };
  for (int k = 0; k < sys.bond_count(); ++k) g_[k] = -rate(k);
  solver_.solve(g_);
  add_constraint_acceleration(sys, r_, g_, s.v);
  lambda_ = 2 / h * g_;
  for (const int k : solver_.dependent_bonds())
    if (!(std::abs(rate(k)) * h <= options_.tolerance * sys.bonds[k].length * sys.bonds[k].length))
      return {1, 0, k, Failure::kSingular};
  return {1};
}

std::string Newton::setting() const {
  return fmt::format("tolerance {:g}", options_.tolerance);
}

}  // namespace taut
