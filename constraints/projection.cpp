#include "constraints/projection.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"
#include "constraints/bond_algebra.hpp"

namespace taut {
namespace {

std::string named(const System& sys, int k) {
  return fmt::format("bond {} ({}-{})", k, sys.bonds[k].i, sys.bonds[k].j);
}

}  // namespace

Projector::Projector(const System& sys)
    : solver_(sys), r_(3, sys.bond_count()), v_ij_(3, sys.bond_count()), b_(sys.bond_count()) {}

void Projector::positions(const System& sys, Vectors& x) {
  constexpr int kMaxIterations = 100;
  // |σ|/d² that must be reached, more where numbers so large have no more digits; it goes on while σ falls
  double shortest = std::numeric_limits<double>::infinity();
  for (const RigidBond& bond : sys.bonds) shortest = std::min(shortest, bond.length);
  const double digit = std::numeric_limits<double>::epsilon() * x.cwiseAbs().maxCoeff();
  const double round_off = std::max(1e-12, 8 * digit / shortest);
  double before = std::numeric_limits<double>::infinity();
  Residual residual;
  for (int n = 0; n < kMaxIterations; ++n) {
    bond_vectors(sys, x, r_);
    residual = {};
    for (int k = 0; k < sys.bond_count(); ++k) {
      const double d = sys.bonds[k].length;
      b_[k] = -sigma(r_.col(k), d);
      residual.see(std::abs(b_[k]) / (d * d), k);
    }
    if (residual.value < round_off && residual.value >= 0.5 * before) return;
    if (residual.value == 0) return;
    before = residual.value;
    solver_.factor(r_);
    if (solver_.singular())
      throw SimulationFailure(
          fmt::format("the start: {} depends on other bonds there, so that no force can hold it: drop it, or "
                      "bend the bonds that lie in line or in a plane",
                      named(sys, solver_.dependent_bonds().front())));
    solver_.solve(b_);
    add_constraint_acceleration(sys, r_, b_, x);
  }
  throw SimulationFailure(fmt::format("the start: {} cannot be brought to its length, |σ|/d² stays at {:.1e}",
                                      named(sys, std::max(residual.bond, 0)), residual.value));
}

void Projector::velocities(const System& sys, const Vectors& x, Vectors& v) {
  bond_vectors(sys, x, r_);
  solver_.factor(r_);
  for (int refine = 0; refine < 2; ++refine) {
    differences(sys, v, v_ij_);
    b_ = -r_.cwiseProduct(v_ij_).colwise().sum().transpose();
    solver_.solve(b_);
    add_constraint_acceleration(sys, r_, b_, v);
  }
}

const Eigen::VectorXd& Projector::multipliers(const System& sys, const State& s, const Vectors* prescribed) {
  bond_vectors(sys, s.x, r_);
  differences(sys, s.v, v_ij_);
  solver_.factor(r_);
  for (int k = 0; k < sys.bond_count(); ++k) {
    Vec3 a_ij = prescribed ? sys.difference(sys.bonds[k], *prescribed) : Vec3(Vec3::Zero());
    sys.for_each_bearer(sys.bonds[k], [&](int a, double c) { a_ij += c * sys.inv_mass[a] * s.f.col(a); });
    b_[k] = -(r_.col(k).dot(a_ij) + v_ij_.col(k).squaredNorm());
  }
  solver_.solve(b_);
  return b_;
}

std::vector<int> rest_anchors(const System& sys, Vectors& v) {
  std::vector<int> moved;
  for (int a = 0; a < sys.atoms(); ++a) {
    if (sys.mass[a] > 0 || v.col(a).isZero(0)) continue;
    if (sys.is_anchor(a)) moved.push_back(a);
    v.col(a).setZero();
  }
  return moved;
}

void bring_to_bonds(const System& sys, State& s, MovingAnchors* anchors) {
  rest_anchors(sys, s.v);
  if (anchors) anchors->begin(s);
  Projector projector(sys);
  projector.positions(sys, s.x);
  projector.velocities(sys, s.x, s.v);
}

void initialize(Integrator& integrator, const Dynamics& dynamics, double h, State& s) {
  bring_to_bonds(dynamics.sys, s, dynamics.anchors);
  integrator.initialize(dynamics, h, s);
}

void initialize(const Dynamics& dynamics, double h, State& s) {
  VelocityVerlet plain;
  initialize(plain, dynamics, h, s);
}

}  // namespace taut
