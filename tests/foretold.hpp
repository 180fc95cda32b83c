#pragma once

// The work that a law's bonds would do, found along a run of feedforward, which does none.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "constraints/bond_algebra.hpp"
#include "constraints/direct_solver.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "constraints/projection.hpp"
#include "forcefield/force_field.hpp"
#include "md/observables.hpp"
#include "systems/scene/scene.hpp"

namespace taut::tests {

// The gains of a centred law, which is fed ¼h⁴|a|².
struct CentredLaw {
  double ah, bh_squared;
};

// Of step n in averages along a run: nothing at both ends, so that derivatives average to nothing in short runs, too.
inline double weight_of(long n, long steps) {
  return std::pow(std::sin(M_PI * static_cast<double>(n) / static_cast<double>(steps)), 2);
}

// What the bonds of each of these laws would do to one run that does not heat: σ of what is fed, through the law's
// recurrence, at work Σ ½(λ + λ₊)Δσ + ¼(δλ₊ − δλ)|Δr|², A δλ = (σ₊ − 2σ + σ₋)/h². By bond and law.
inline Eigen::MatrixXd foretold_by_bond(const Scene& scene, const std::vector<CentredLaw>& laws) {
  const System& sys = scene.system;
  const double h = scene.run.h();
  const int m = sys.bond_count(), all = static_cast<int>(laws.size());
  ForceField forces(sys, scene.start.box, scene.terms);
  Baumgarte method(sys, Feedforward::Options{}, h);
  const Dynamics dynamics{sys, forces, method};
  State s = scene.start;
  initialize(dynamics, h, s);
  DirectSolver solver(sys);
  Vectors r(3, m), r_next(3, m), a_ij(3, m);
  Eigen::MatrixXd work = Eigen::MatrixXd::Zero(m, all), now = work, before = work, next = work;
  Eigen::VectorXd square_before = Eigen::VectorXd::Zero(m), more = square_before;
  differences(sys, s.x, r);
  double weights = 0;
  for (long n = 0; n < scene.run.steps; ++n) {
    differences(sys, s.f * sys.inv_mass.asDiagonal(), a_ij);
    const Eigen::VectorXd lambda = method.lambda(),
                          fed = std::pow(h, 4) / 4 * a_ij.colwise().squaredNorm().transpose();
    EXPECT_TRUE(step(dynamics, h, s).converged());
    differences(sys, s.x, r_next);
    solver.factor(r);
    const double weight = weight_of(n, scene.run.steps);
    weights += weight;
    const Eigen::VectorXd square = (r_next - r).colwise().squaredNorm();
    for (int l = 0; l < all; ++l) {
      const auto& [ah, bh_squared] = laws[static_cast<std::size_t>(l)];
      next.col(l) = (fed + (2 - bh_squared) * now.col(l) - (1 - ah) * before.col(l)) / (1 + ah);
      more = (next.col(l) - 2 * now.col(l) + before.col(l)) / (h * h);  // δλ
      solver.solve(more);
      work.col(l) += weight * (0.5 * (lambda + method.lambda()).cwiseProduct(next.col(l) - now.col(l)) -
                               0.25 * more.cwiseProduct(square - square_before));
    }
    square_before = square;
    before = now;
    now = next;
    r = r_next;
  }
  const double ns = weights * h / 1000;
  return work / ns / degrees_of_freedom(sys, m, 3).total();
}

// By law.
inline Eigen::VectorXd foretold(const Scene& scene, const std::vector<CentredLaw>& laws) {
  return foretold_by_bond(scene, laws).colwise().sum();
}

}  // namespace taut::tests
