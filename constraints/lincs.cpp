#include "constraints/lincs.hpp"

#include <fmt/format.h>

#include "constraints/bond_algebra.hpp"
#include "md/errors.hpp"

namespace taut {

Lincs::Lincs(const System& sys, const Options& options, double)
    : options_(options),
      couplings_(sys),
      directions_(3, sys.bond_count()),
      scale_(couplings_.reduced_inv_mass.cwiseSqrt().cwiseInverse()),
      c_(couplings_.pairs.size()),
      rhs_(sys.bond_count()),
      sum_(sys.bond_count()),
      power_(sys.bond_count()),
      g_(sys.bond_count()),
      lambda_(Eigen::VectorXd::Zero(sys.bond_count())) {
  if (options.order < 0) throw InputError(fmt::format("method.order: {}, expected 0 or more", options.order));
  if (options.iterations < 0)
    throw InputError(fmt::format("method.iterations: {}, expected 0 or more", options.iterations));
}

void Lincs::find_coupling() {
  for (Eigen::Index e = 0; e < c_.size(); ++e) {
    const auto [k, l] = couplings_.pairs[e];
    c_[e] =
        -couplings_.signed_inv_mass[e] * scale_[k] * scale_[l] * directions_.col(k).dot(directions_.col(l));
  }
}

void Lincs::apply(const System& sys, Vectors& y) {
  sum_ = rhs_;
  for (int n = 0; n < options_.order; ++n) {
    power_.setZero();
    for (Eigen::Index e = 0; e < c_.size(); ++e) {
      const auto [k, l] = couplings_.pairs[e];
      power_[k] += c_[e] * rhs_[l];
      power_[l] += c_[e] * rhs_[k];
    }
    sum_ += power_;
    rhs_.swap(power_);
  }
  sum_.array() *= -scale_.array();
  add_constraint_acceleration(sys, directions_, sum_, y);
  g_ += sum_;
}

SolveStats Lincs::project_positions(const System& sys, double h, State& s) {
  for (int k = 0; k < sys.bond_count(); ++k) {
    const auto& [i, j, d] = sys.bonds[k];
    const Vec3 r = s.x.col(j) - s.x.col(i);
    directions_.col(k) = (r - h * (s.v.col(j) - s.v.col(i))).normalized();
    rhs_[k] = scale_[k] * (directions_.col(k).dot(r) - d);
  }
  find_coupling();
  g_.setZero();
  apply(sys, s.x);
  Residual residual;
  for (int iteration = 0; iteration <= options_.iterations; ++iteration) {
    residual = {};
    for (int k = 0; k < sys.bond_count(); ++k) {
      const auto& [i, j, d] = sys.bonds[k];
      const double square = (s.x.col(j) - s.x.col(i)).squaredNorm();
      rhs_[k] = scale_[k] * (d - std::sqrt(std::max(0.0, 2 * d * d - square)));
      residual.see(0.5 * std::abs(square / (d * d) - 1), k);
    }
    if (iteration < options_.iterations) apply(sys, s.x);
  }
  sum_ = g_ / h;
  add_constraint_acceleration(sys, directions_, sum_, s.v);
  return {options_.iterations + 1, residual.value, residual.bond};
}

SolveStats Lincs::project_velocities(const System& sys, double h, State& s) {
  for (int k = 0; k < sys.bond_count(); ++k) {
    const auto& [i, j, d] = sys.bonds[k];
    directions_.col(k) = (s.x.col(j) - s.x.col(i)).normalized();
    rhs_[k] = scale_[k] * directions_.col(k).dot(s.v.col(j) - s.v.col(i));
  }
  find_coupling();
  g_.setZero();
  apply(sys, s.v);
  for (int k = 0; k < sys.bond_count(); ++k) lambda_[k] = 2 / h * g_[k] / sys.bonds[k].length;
  return {1};
}

std::string Lincs::setting() const {
  return fmt::format("order {}, {} correction{}", options_.order, options_.iterations,
                     options_.iterations == 1 ? "" : "s");
}

}  // namespace taut
