#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

#include "forcefield/force_field.hpp"

namespace taut {

inline Vectors columns(std::initializer_list<Vec3> points) {
  Vectors x(3, points.size());
  int a = 0;
  for (const Vec3& p : points) x.col(a++) = p;
  return x;
}

struct Evaluated {
  double energy;  // [kJ/mol]
  Vectors f;      // [kJ/mol/nm]
};

struct Bench {
  System sys;
  Box box;
  ForceField forces;

  Bench(int n, const Terms& terms, const Box& in = {})
      : sys(make_system(Eigen::VectorXd::Constant(n, 2.0), {})), box(in), forces(sys, box, terms) {}

  Evaluated at(const Vectors& x) {
    State s{x, Vectors::Zero(3, x.cols()), Vectors::Constant(3, x.cols(), NAN), 0, box};
    const double energy = forces.evaluate_energy(sys, s);  // whatever f was
    return {energy, s.f};
  }

  Eigen::Matrix3d virial_at(const Vectors& x) {
    State s{x, {}, {}, 0, box};
    ForceField::Evaluation evaluation;
    forces.evaluate(sys, s, evaluation);
    return forces.virial(s, evaluation);
  }

  Energies energies_at(const Vectors& x) {
    State s{x, {}, {}, 0, box};
    ForceField::Evaluation evaluation;
    forces.evaluate(sys, s, evaluation);
    return forces.energies(s, evaluation);
  }
};

inline Evaluated evaluate(const Terms& terms, const Vectors& x, const Box& box = {}) {
  return Bench(static_cast<int>(x.cols()), terms, box).at(x);
}

// f = −dE/dx by central differences, to a part in 10⁷ of the largest force.
inline void expect_forces_are_minus_the_slope(const Terms& terms, const Vectors& x, const Box& box = {}) {
  Bench bench(static_cast<int>(x.cols()), terms, box);
  const Vectors f = bench.at(x).f;
  const double step = 1e-5, largest = f.cwiseAbs().maxCoeff();
  EXPECT_GT(largest, 0);
  for (int a = 0; a < x.cols(); ++a)
    for (int d = 0; d < 3; ++d) {
      Vectors up = x, down = x;
      up(d, a) += step;
      down(d, a) -= step;
      const double slope = (bench.at(up).energy - bench.at(down).energy) / (2 * step);
      EXPECT_NEAR(f(d, a), -slope, 1e-7 * largest) << "atom " << a << ", axis " << d;
    }
}

}  // namespace taut
