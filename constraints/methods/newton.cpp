#include "constraints/methods/newton.hpp"

#include <fmt/format.h>

#include <limits>

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

  g_ = 0.5 * h * h * lambda_;
  add_constraint_acceleration(sys, r_old_, g_, s.x);
  SolveStats stats{.failure = Failure::kNoConvergence};
  bool exactly = false;  // then exact_ is of this step
  for (double before = std::numeric_limits<double>::infinity();;) {
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
    exactly |= residual.value > before;
    before = residual.value;
    const bool solved = active_set_ ? solve_one_sided(sys, r_old_, stats)
                        : exactly   ? solve_exactly(dg_, stats)
                                    : solve(dg_, stats);
    if (!solved) return stats;
    add_constraint_acceleration(sys, r_old_, dg_, s.x);
    g_ += dg_;
    ++stats.iterations;
  }
  if (!stats.converged() && !active_set_) explain_by_pivots(exactly, stats);
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
  const auto rate = [&](int k) {
    const auto& [i, j, d] = sys.bond(k);
    return r_.col(k).dot(s.v.col(j) - s.v.col(i));
  };
  for (int k = 0; k < sys.all_bonds(); ++k) g_[k] = -rate(k);
  solver_.solve(g_);
  add_constraint_acceleration(sys, r_, g_, s.v);
  lambda_ = 2 / h * g_;
  for (const int k : solver_.dependent_bonds())
    if (!(std::abs(rate(k)) * h <= options_.tolerance * sys.bond(k).length * sys.bond(k).length))
      return {1, 0, k, Failure::kSingular};
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
