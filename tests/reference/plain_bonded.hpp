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

// What a law says of a term: its energy, and the slope of it along the distance or angle.
struct EnergyAndSlope {
  double energy, slope;
};

// E(r)
template <class Term>
double add_of_distances(const std::vector<Term>& terms, const Vectors& x, Vectors& f, const auto& law) {
  double sum = 0;
  for (const Term& t : terms) {
    const Vec3 d = x.col(t.j) - x.col(t.i);
    const double r = d.norm();
    const EnergyAndSlope at = law(t, r);
    sum += at.energy;
    const Vec3 pull = (r > 0 ? at.slope / r : 0.0) * d;
    f.col(t.i) += pull;
    f.col(t.j) -= pull;
  }
  return sum;
}

// E(θ)
template <class Term>
double add_of_angles(const std::vector<Term>& terms, const Vectors& x, Vectors& f, const auto& law) {
  double sum = 0;
  for (const Term& t : terms) {
    const Angle angle(x.col(t.i) - x.col(t.j), x.col(t.k) - x.col(t.j));
    const EnergyAndSlope at = law(t, angle.theta);
    sum += at.energy;
    f.col(t.i) -= at.slope * angle.grad_i;
    f.col(t.k) -= at.slope * angle.grad_k;
    f.col(t.j) += at.slope * (angle.grad_i + angle.grad_k);
  }
  return sum;
}

// E(φ)
template <class Term>
double add_of_dihedrals(const std::vector<Term>& terms, const Vectors& x, Vectors& f, const auto& law) {
  double sum = 0;
  for (const Term& t : terms) {
    const Dihedral d(x.col(t.i), x.col(t.j), x.col(t.k), x.col(t.l));
    const EnergyAndSlope at = law(t, d.phi);
    sum += at.energy;
    f.col(t.i) -= at.slope * d.grad_i;
    f.col(t.j) -= at.slope * d.grad_j;
    f.col(t.k) -= at.slope * d.grad_k;
    f.col(t.l) -= at.slope * d.grad_l;
  }
  return sum;
}

// E = K(1 + cos θ)
inline double add_cosine_angles(const std::vector<CosineAngle>& angles, const Vectors& x, Vectors& f) {
  return add_of_angles(angles, x, f, [](const CosineAngle& t, double theta) {
    return EnergyAndSlope{t.stiffness * (1 + std::cos(theta)), -t.stiffness * std::sin(theta)};
  });
}

// E = ½K(cos θ − cos θ₀)²
inline double add_cosine_squared_angles(const std::vector<CosineSquaredAngle>& angles, const Vectors& x,
                                        Vectors& f) {
  return add_of_angles(angles, x, f, [](const CosineSquaredAngle& t, double theta) {
    const double off = std::cos(theta) - t.cosine;
    return EnergyAndSlope{0.5 * t.stiffness * off * off, -t.stiffness * off * std::sin(theta)};
  });
}

// E = ½K(cos θ − cos θ₀)²/sin²θ
inline double add_restricted_angles(const std::vector<RestrictedAngle>& angles, const Vectors& x,
                                    Vectors& f) {
  return add_of_angles(angles, x, f, [](const RestrictedAngle& t, double theta) {
    const double off = (std::cos(theta) - t.cosine) / std::sin(theta);
    return EnergyAndSlope{0.5 * t.stiffness * off * off,
                          -t.stiffness * off * (1 + off * std::cos(theta) / std::sin(theta))};
  });
}

// E = k qq (k_rf r² − c_rf) up to the cutoff
inline double add_field_pairs(const std::vector<FieldPair>& pairs, const Vectors& x, Vectors& f) {
  double energy = 0;
  for (const auto& [i, j, curvature, depth, cutoff] : pairs) {
    const Vec3 d = x.col(j) - x.col(i);
    if (d.norm() > cutoff) continue;
    energy += curvature * d.squaredNorm() - depth;
    f.col(i) += 2 * curvature * d;
    f.col(j) -= 2 * curvature * d;
  }
  return energy;
}

// E by a table of the distance, and by one of the angle
inline double add_tabulated_bonds(const std::vector<TabulatedBond>& bonds, const Vectors& x, Vectors& f) {
  return add_of_distances(bonds, x, f, [](const TabulatedBond& t, double r) {
    const PlainSpline spline(*t.energy);
    return EnergyAndSlope{spline.value(r), spline.slope(r)};
  });
}
inline double add_tabulated_angles(const std::vector<TabulatedAngle>& angles, const Vectors& x, Vectors& f) {
  return add_of_angles(angles, x, f, [](const TabulatedAngle& t, double theta) {
    const PlainSpline spline(*t.energy);
    return EnergyAndSlope{spline.value(theta), spline.slope(theta)};
  });
}

// E = ½k(r − d)²
inline double add_bonds(const std::vector<HarmonicBond>& bonds, const Vectors& x, Vectors& f) {
  return add_of_distances(bonds, x, f, [](const HarmonicBond& t, double r) {
    const double stretch = r - t.length;
    return EnergyAndSlope{0.5 * t.k * stretch * stretch, t.k * stretch};
  });
}

// E = ½k(θ − θ₀)²
inline double add_angles(const std::vector<HarmonicAngle>& angles, const Vectors& x, Vectors& f) {
  return add_of_angles(angles, x, f, [](const HarmonicAngle& t, double theta) {
    const double bend = theta - t.angle;
    return EnergyAndSlope{0.5 * t.stiffness * bend * bend, t.stiffness * bend};
  });
}

// E = k(1 + cos(nφ − φ₀))
inline double add_torsions(const std::vector<PeriodicTorsion>& torsions, const Vectors& x, Vectors& f) {
  return add_of_dihedrals(torsions, x, f, [](const PeriodicTorsion& t, double phi) {
    const double argument = t.periodicity * phi - t.phase;
    return EnergyAndSlope{t.amplitude * (1 + std::cos(argument)),
                          -t.amplitude * t.periodicity * std::sin(argument)};
  });
}

// E = Σ c_n cosⁿψ, ψ = φ − π: cos ψ = −cos φ and dE/dφ = sin φ dE/d(cos ψ)
// (Ryckaert and Bellemans 1975, doi:10.1016/0009-2614(75)85513-8).
inline double add_rb_torsions(const std::vector<RyckaertBellemans>& torsions, const Vectors& x, Vectors& f) {
  return add_of_dihedrals(torsions, x, f, [](const RyckaertBellemans& t, double phi) {
    const double u = -std::cos(phi);
    double value = 0, slope = 0;  // Horner
    for (int n = 5; n >= 0; --n) {
      slope = slope * u + value;
      value = value * u + t.c[n];
    }
    return EnergyAndSlope{value, slope * std::sin(phi)};
  });
}

// E = ½k d², d = φ − φ₀ between −π and π
inline double add_harmonic_torsions(const std::vector<HarmonicTorsion>& torsions, const Vectors& x,
                                    Vectors& f) {
  return add_of_dihedrals(torsions, x, f, [](const HarmonicTorsion& t, double phi) {
    const double turn = std::remainder(phi - t.angle, 2 * std::numbers::pi);
    return EnergyAndSlope{0.5 * t.stiffness * turn * turn, t.stiffness * turn};
  });
}

// E = sin³θ₁ sin³θ₂ Σ c_n cosⁿφ
inline double add_bending_torsions(const std::vector<BendingTorsion>& torsions, const Vectors& x,
                                   Vectors& f) {
  double energy = 0;
  for (const auto& t : torsions) {
    const Dihedral d(x.col(t.i), x.col(t.j), x.col(t.k), x.col(t.l));
    const Angle one(x.col(t.i) - x.col(t.j), x.col(t.k) - x.col(t.j)),
        two(x.col(t.j) - x.col(t.k), x.col(t.l) - x.col(t.k));
    const double s1 = std::sin(one.theta), s2 = std::sin(two.theta), c = std::cos(d.phi);
    double value = 0, slope = 0;  // Horner
    for (int n = 4; n >= 0; --n) {
      slope = slope * c + value;
      value = value * c + t.c[n];
    }
    const double cubes = std::pow(s1 * s2, 3);
    energy += cubes * value;
    const double along_phi = -cubes * slope * std::sin(d.phi);
    f.col(t.i) -= along_phi * d.grad_i;
    f.col(t.j) -= along_phi * d.grad_j;
    f.col(t.k) -= along_phi * d.grad_k;
    f.col(t.l) -= along_phi * d.grad_l;
    const auto bend = [&](int i, int j, int k, const Angle& at, double cotangent) {
      const double dE = 3 * cubes * value * cotangent;
      f.col(i) -= dE * at.grad_i;
      f.col(k) -= dE * at.grad_k;
      f.col(j) += dE * (at.grad_i + at.grad_k);
    };
    bend(t.i, t.j, t.k, one, std::cos(one.theta) / s1);
    bend(t.j, t.k, t.l, two, std::cos(two.theta) / s2);
  }
  return energy;
}

// E = −½k r₀² ln(1 − (r/r₀)²) (Kremer and Grest 1990, doi:10.1063/1.458541)
inline double add_fene(const std::vector<Fene>& bonds, const Vectors& x, Vectors& f) {
  return add_of_distances(bonds, x, f, [](const Fene& t, double r) {
    const double slack = 1 - r * r / (t.r0 * t.r0);
    return EnergyAndSlope{-0.5 * t.k * t.r0 * t.r0 * std::log(slack), t.k * r / slack};
  });
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
