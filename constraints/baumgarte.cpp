#include "constraints/baumgarte.hpp"

#include <fmt/format.h>

#include "constraints/bond_algebra.hpp"
#include "md/errors.hpp"

namespace taut {

Baumgarte::Baumgarte(const System& sys, const Options& options, double h)
    : gains_(choose_gains(options.gains, options.alpha_per_ps, options.beta_per_ps, h)),
      passes_(options.passes),
      h_(h),
      solver_(sys),
      r_(3, sys.bond_count()),
      w_ij_(3, sys.bond_count()),
      y_(3, sys.atoms()),
      known_(sys.bond_count()),
      lambda_(Eigen::VectorXd::Zero(sys.bond_count())) {
  if (passes_ < 1) throw InputError(fmt::format("method.passes: {}, expected 1 or more", passes_));
}

SolveStats Baumgarte::add_forces(const System& sys, double h, State& s) {
  const auto [alpha, beta] = gains_;
  differences(sys, s.x, r_);
  Residual residual;
  for (int k = 0; k < sys.bond_count(); ++k) {
    const auto& [i, j, d] = sys.bonds[k];
    const Vec3 a_ij = sys.inv_mass[j] * s.f.col(j) - sys.inv_mass[i] * s.f.col(i);
    w_ij_.col(k) = s.v.col(j) - s.v.col(i) + 0.5 * h * a_ij;
    const double c = sigma(r_.col(k), d);
    known_[k] = r_.col(k).dot(a_ij) + 2 * alpha * r_.col(k).dot(w_ij_.col(k)) + beta * beta * c;
    residual.see(std::abs(c) / (d * d), k);
  }
  solver_.factor(r_);
  if (solver_.singular()) return {0, residual.value, solver_.dependent_bonds().front(), "A is singular"};

  for (int pass = 0; pass < passes_; ++pass) {
    y_.setZero();
    add_constraint_acceleration(sys, r_, lambda_, y_);
    for (int k = 0; k < sys.bond_count(); ++k) {
      const auto& [i, j, d] = sys.bonds[k];
      const Vec3 v_ij = w_ij_.col(k) + 0.5 * h * (y_.col(j) - y_.col(i));
      lambda_[k] = -(known_[k] + v_ij.squaredNorm()) / (1 + alpha * h);
    }
    solver_.solve(lambda_);
  }
  add_constraint_force(sys, r_, lambda_, s.f);
  return {passes_, residual.value, residual.bond};
}

std::string Baumgarte::setting() const {
  return fmt::format("α {:.6g}/ps, β {:.6g}/ps (αh {:.4g}, βh {:.4g}), {} solve{} a step", gains_.alpha,
                     gains_.beta, gains_.alpha * h_, gains_.beta * h_, passes_, passes_ == 1 ? "" : "s");
}

}  // namespace taut
