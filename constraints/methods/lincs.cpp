#include "constraints/methods/lincs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "constraints/bond_algebra.hpp"

namespace taut {

BondTriangles::BondTriangles(const std::vector<RigidBond>& bonds) {
  for (const auto& [i, j, d] : bonds) tied_.insert(std::minmax(i, j));
}

bool BondTriangles::hold(const RigidBond& k, const RigidBond& l) const {
  const auto tied = [&](int a, int b) { return tied_.contains(std::minmax(a, b)); };
  if (k.i == l.i) return tied(k.j, l.j);
  if (k.i == l.j) return tied(k.j, l.i);
  if (k.j == l.i) return tied(k.i, l.j);
  return k.j == l.j && tied(k.i, l.i);
}

namespace {

// Moves the couplings inside triangles to the front, and returns their number.
Eigen::Index triangles_first(const System& sys, Couplings& couplings) {
  const BondTriangles triangles(sys.bonds);
  std::size_t inside = 0;
  for (std::size_t e = 0; e < couplings.pairs.size(); ++e) {
    const auto [k, l] = couplings.pairs[e];
    if (!triangles.hold(sys.bonds[k], sys.bonds[l])) continue;
    std::swap(couplings.pairs[e], couplings.pairs[inside]);
    std::swap(couplings.signed_inv_mass[e], couplings.signed_inv_mass[inside]);
    ++inside;
  }
  return static_cast<Eigen::Index>(inside);
}

}  // namespace

Lincs::Lincs(const System& sys, const Options& options, double)
    : options_(options),
      couplings_(sys),
      in_triangles_(triangles_first(sys, couplings_)),
      directions_(3, sys.bond_count()),
      scale_(couplings_.reduced_inv_mass.cwiseSqrt().cwiseInverse()),
      c_(couplings_.pairs.size()),
      rhs_(sys.bond_count()),
      sum_(sys.bond_count()),
      power_(sys.bond_count()),
      g_(sys.bond_count()),
      lambda_(Eigen::VectorXd::Zero(sys.bond_count())) {}

void Lincs::find_coupling() {
  for (Eigen::Index e = 0; e < c_.size(); ++e) {
    const auto [k, l] = couplings_.pairs[e];
    c_[e] =
        -couplings_.signed_inv_mass[e] * scale_[k] * scale_[l] * directions_.col(k).dot(directions_.col(l));
  }
}

void Lincs::multiply(Eigen::Index entries) {
  power_.setZero();
  for (Eigen::Index e = 0; e < entries; ++e) {
    const auto [k, l] = couplings_.pairs[e];
    power_[k] += c_[e] * rhs_[l];
    power_[l] += c_[e] * rhs_[k];
  }
  sum_ += power_;
  rhs_.swap(power_);
}

void Lincs::apply(const System& sys, Vectors& y) {
  sum_ = rhs_;
  for (int n = 0; n < options_.order; ++n) multiply(c_.size());
  if (in_triangles_ > 0)
    for (int n = 0; n < options_.order; ++n) multiply(in_triangles_);
  sum_.array() *= -scale_.array();
  add_constraint_acceleration(sys, directions_, sum_, y);
  g_ += sum_;
}

SolveStats Lincs::project_positions(const System& sys, double h, State& s) {
  for (int k = 0; k < sys.bond_count(); ++k) {
    const Vec3 r = sys.along(sys.bonds[k], s.x);
    directions_.col(k) = (r - h * sys.difference(sys.bonds[k], s.v)).normalized();
    rhs_[k] = scale_[k] * (directions_.col(k).dot(r) - sys.bonds[k].length);
  }
  find_coupling();
  g_.setZero();
  apply(sys, s.x);
  Residual residual;
  for (int iteration = 0; iteration <= options_.iterations; ++iteration) {
    residual = {};
    for (int k = 0; k < sys.bond_count(); ++k) {
      const double d = sys.bonds[k].length;
      const double square = sys.along(sys.bonds[k], s.x).squaredNorm();
      rhs_[k] = scale_[k] * (d - std::sqrt(std::max(0.0, 2 * d * d - square)));
      residual.see(0.5 * std::abs(square / (d * d) - 1), k);
    }
    if (iteration < options_.iterations) apply(sys, s.x);
  }
  sum_ = g_ / h;
  add_constraint_acceleration(sys, directions_, sum_, s.v);
  find_lambda(sys, 2 / (h * h));
  return {options_.iterations + 1, residual.value, residual.bond};
}

SolveStats Lincs::project_velocities(const System& sys, double h, State& s) {
  for (int k = 0; k < sys.bond_count(); ++k) {
    directions_.col(k) = sys.along(sys.bonds[k], s.x).normalized();
    rhs_[k] = scale_[k] * directions_.col(k).dot(sys.difference(sys.bonds[k], s.v));
  }
  find_coupling();
  g_.setZero();
  apply(sys, s.v);
  find_lambda(sys, 2 / h);
  return {1};
}

// g along the directions, as forces along the bonds.
void Lincs::find_lambda(const System& sys, double by) {
  for (int k = 0; k < sys.bond_count(); ++k) lambda_[k] = by * g_[k] / sys.bonds[k].length;
}

std::string Lincs::setting() const {
  return fmt::format("order {}, {} correction{}", options_.order, options_.iterations,
                     options_.iterations == 1 ? "" : "s");
}

}  // namespace taut
