#include "constraints/methods/penalty.hpp"

#include <fmt/format.h>

#include "constraints/bond_algebra.hpp"

namespace taut {

Penalty::Penalty(const System& sys, const Options& options, double h)
    : k_(sys.bond_count()), lambda_(Eigen::VectorXd::Zero(sys.bond_count())) {
  for (int k = 0; k < sys.bond_count(); ++k) {
    const double mu = 1 / sys.reduced_inv_mass(sys.bonds[k]);
    const double omega = options.omega_h / h;
    k_[k] = options.k.value_or(mu * omega * omega);
  }
}

SolveStats Penalty::add_forces(const System& sys, const Push&, State& s) {
  Residual residual;
  for (int k = 0; k < sys.bond_count(); ++k) {
    const double d = sys.bonds[k].length;
    const Vec3 r = sys.along(sys.bonds[k], s.x);
    const double length = r.norm();
    lambda_[k] = -k_[k] * (length - d) / length;
    sys.for_each_bearer(sys.bonds[k], [&](int a, double c) { s.f.col(a) += c * lambda_[k] * r; });
    residual.see(std::abs(sigma(r, d)) / (d * d), k);
  }
  return {0, residual.value, residual.bond};
}

std::string Penalty::setting() const {
  if (k_.size() == 0) return "no bonds";
  return fmt::format("springs of {:.4g} to {:.4g} kJ/mol/nm²", k_.minCoeff(), k_.maxCoeff());
}

double Penalty::spring_energy(const System& sys, const Vectors& x) const {
  double energy = 0;
  for (int k = 0; k < sys.bond_count(); ++k) {
    const double stretch = sys.along(sys.bonds[k], x).norm() - sys.bonds[k].length;
    energy += 0.5 * k_[k] * stretch * stretch;
  }
  return energy;
}

}  // namespace taut
