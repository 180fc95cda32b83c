#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "forcefield/bonded/dihedral.hpp"
#include "forcefield/terms.hpp"
#include "md/units.hpp"
#include "plain_spline.hpp"

// Forces between atoms that are neighbours along a molecule, written down plainly: one term after the other, in
// angles and their gradients. Each function adds its forces to f and returns its energy [kJ/mol]. Molecules are
// whole in x, so separations are plain differences.

namespace taut::tests {

// The angle θ at the middle of three atoms and its gradient. With a and c the arms and p = a × c,
//     θ = atan2(|p|, a·c),   ∂θ/∂x_i = a × p / (a²|p|),   ∂θ/∂x_k = −c × p / (c²|p|).
// On a straight line the direction is undefined and the gradient left at zero.
struct Angle {
  double theta;
  Vec3 grad_i = Vec3::Zero(), grad_k = Vec3::Zero();  // [rad/nm]; grad_j is minus their sum

  Angle(const Vec3& a, const Vec3& c) {
    const Vec3 p = a.cross(c);
    const double sine = p.norm();
    theta = std::atan2(sine, a.dot(c));
    if (!(sine > 0)) return;
    grad_i = a.cross(p) / (a.squaredNorm() * sine);
    grad_k = -c.cross(p) / (c.squaredNorm() * sine);
  }
};

template <class Torsion>
Dihedral dihedral(const Torsion& t, const Vectors& x) {
  return {x.col(t.i), x.col(t.j), x.col(t.k), x.col(t.l)};
}

template <class Torsion>
void add_gradient(const Torsion& t, const Dihedral& d, double dE_dphi, Vectors& f) {
  f.col(t.i) -= dE_dphi * d.grad_i;
  f.col(t.j) -= dE_dphi * d.grad_j;
  f.col(t.k) -= dE_dphi * d.grad_k;
  f.col(t.l) -= dE_dphi * d.grad_l;
}

// E = K(1 + cos θ)
inline double add_cosine_angles(const std::vector<CosineAngle>& angles, const Vectors& x, Vectors& f) {
  double energy = 0;
  for (const auto& [i, j, k, stiffness] : angles) {
    const Angle at(x.col(i) - x.col(j), x.col(k) - x.col(j));
    energy += stiffness * (1 + std::cos(at.theta));
    const double slope = -stiffness * std::sin(at.theta);
    f.col(i) -= slope * at.grad_i;
    f.col(k) -= slope * at.grad_k;
    f.col(j) += slope * (at.grad_i + at.grad_k);
  }
  return energy;
}

// E = ½K(cos θ − cos θ₀)²
inline double add_cosine_squared_angles(const std::vector<CosineSquaredAngle>& angles, const Vectors& x,
                                        Vectors& f) {
  double energy = 0;
  for (const auto& [i, j, k, cosine, stiffness] : angles) {
    const Angle at(x.col(i) - x.col(j), x.col(k) - x.col(j));
    const double off = std::cos(at.theta) - cosine;
    energy += 0.5 * stiffness * off * off;
    const double slope = -stiffness * off * std::sin(at.theta);
    f.col(i) -= slope * at.grad_i;
    f.col(k) -= slope * at.grad_k;
    f.col(j) += slope * (at.grad_i + at.grad_k);
  }
  return energy;
}

// E by a table of the distance, and by one of the angle
inline double add_tabulated_bonds(const std::vector<TabulatedBond>& bonds, const Vectors& x, Vectors& f) {
  double energy = 0;
  for (const auto& [i, j, table] : bonds) {
    const Vec3 d = x.col(j) - x.col(i);
    const PlainSpline spline(*table);
    energy += spline.value(d.norm());
    const Vec3 pull = spline.slope(d.norm()) / d.norm() * d;
    f.col(i) += pull;
    f.col(j) -= pull;
  }
  return energy;
}
inline double add_tabulated_angles(const std::vector<TabulatedAngle>& angles, const Vectors& x, Vectors& f) {
  double energy = 0;
  for (const auto& [i, j, k, table] : angles) {
    const Angle at(x.col(i) - x.col(j), x.col(k) - x.col(j));
    const PlainSpline spline(*table);
    energy += spline.value(at.theta);
    const double slope = spline.slope(at.theta);
    f.col(i) -= slope * at.grad_i;
    f.col(k) -= slope * at.grad_k;
    f.col(j) += slope * (at.grad_i + at.grad_k);
  }
  return energy;
}

// E = ½k(r − d)²
inline double add_bonds(const std::vector<HarmonicBond>& bonds, const Vectors& x, Vectors& f) {
  double energy = 0;
  for (const auto& [i, j, length, k] : bonds) {
    const Vec3 d = x.col(j) - x.col(i);
    const double r = d.norm(), stretch = r - length;
    energy += 0.5 * k * stretch * stretch;
    const Vec3 pull = d * (r > 0 ? k * stretch / r : 0.0);
    f.col(i) += pull;
    f.col(j) -= pull;
  }
  return energy;
}

// E = ½k(θ − θ₀)²
inline double add_angles(const std::vector<HarmonicAngle>& angles, const Vectors& x, Vectors& f) {
  double energy = 0;
  for (const auto& [i, j, k, angle, stiffness] : angles) {
    const Angle a(x.col(i) - x.col(j), x.col(k) - x.col(j));
    const double bend = a.theta - angle;
    energy += 0.5 * stiffness * bend * bend;
    f.col(i) -= stiffness * bend * a.grad_i;
    f.col(k) -= stiffness * bend * a.grad_k;
    f.col(j) += stiffness * bend * (a.grad_i + a.grad_k);
  }
  return energy;
}

// E = k(1 + cos(nφ − φ₀))
inline double add_torsions(const std::vector<PeriodicTorsion>& torsions, const Vectors& x, Vectors& f) {
  double energy = 0;
  for (const auto& t : torsions) {
    const Dihedral d = dihedral(t, x);
    const double argument = t.periodicity * d.phi - t.phase;
    energy += t.amplitude * (1 + std::cos(argument));
    add_gradient(t, d, -t.amplitude * t.periodicity * std::sin(argument), f);
  }
  return energy;
}

// E = Σ c_n cosⁿψ, ψ = φ − π: cos ψ = −cos φ and dE/dφ = sin φ dE/d(cos ψ)
// (Ryckaert and Bellemans 1975, doi:10.1016/0009-2614(75)85513-8).
inline double add_rb_torsions(const std::vector<RyckaertBellemans>& torsions, const Vectors& x, Vectors& f) {
  double energy = 0;
  for (const auto& t : torsions) {
    const Dihedral d = dihedral(t, x);
    const double u = -std::cos(d.phi);
    double value = 0, slope = 0;  // Horner
    for (int n = 5; n >= 0; --n) {
      slope = slope * u + value;
      value = value * u + t.c[n];
    }
    energy += value;
    add_gradient(t, d, slope * std::sin(d.phi), f);
  }
  return energy;
}

// E = ½k d², d = φ − φ₀ between −π and π
inline double add_harmonic_torsions(const std::vector<HarmonicTorsion>& torsions, const Vectors& x,
                                    Vectors& f) {
  double energy = 0;
  for (const auto& t : torsions) {
    const Dihedral d = dihedral(t, x);
    const double turn = std::remainder(d.phi - t.angle, 2 * std::numbers::pi);
    energy += 0.5 * t.stiffness * turn * turn;
    add_gradient(t, d, t.stiffness * turn, f);
  }
  return energy;
}

// E = −½k r₀² ln(1 − (r/r₀)²) (Kremer and Grest 1990, doi:10.1063/1.458541)
inline double add_fene(const std::vector<Fene>& bonds, const Vectors& x, Vectors& f) {
  double energy = 0;
  for (const auto& [i, j, k, r0] : bonds) {
    const Vec3 d = x.col(j) - x.col(i);
    const double slack = 1 - d.squaredNorm() / (r0 * r0);
    energy -= 0.5 * k * r0 * r0 * std::log(slack);
    const Vec3 pull = d * (k / slack);
    f.col(i) += pull;
    f.col(j) -= pull;
  }
  return energy;
}

// E = 4ε((σ/r)¹² − (σ/r)⁶) + k qq/r
inline double add_exceptions(const std::vector<PairException>& exceptions, const Vectors& x, Vectors& f) {
  double energy = 0;
  for (const auto& e : exceptions) {
    const Vec3 d = x.col(e.i) - x.col(e.j);
    const double inv_r2 = 1 / d.squaredNorm();
    const double s2 = e.sigma * e.sigma * inv_r2, s6 = s2 * s2 * s2;
    const double coulomb = kCoulomb * e.charge_product * std::sqrt(inv_r2);
    energy += 4 * e.epsilon * (s6 - 1) * s6 + coulomb;
    const Vec3 push = (4 * e.epsilon * (12 * s6 - 6) * s6 + coulomb) * inv_r2 * d;
    f.col(e.i) += push;
    f.col(e.j) -= push;
  }
  return energy;
}

}  // namespace taut::tests
