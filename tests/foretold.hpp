#pragma once

// The work that a law's bonds would do, found along a run of feedforward, which does none.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "constraints/bond_algebra.hpp"
#include "constraints/direct_solver.hpp"
#include "constraints/methods/feedforward.hpp"
#include "constraints/methods/guess.hpp"
#include "constraints/methods/propagator.hpp"
#include "constraints/projection.hpp"
#include "forcefield/force_field.hpp"
#include "md/observables.hpp"
#include "systems/scene.hpp"

namespace taut::tests {

// A law's gains, and what it is fed: by a guess of λ what that misses, without one centred damping's ¼h⁴|a|².
struct Law {
  double ah, bh_squared;
  std::optional<Guess> guess = {};
  Damping damping = Damping::kDiscrete;
};

// Of step n in averages along a run: nothing at both ends, so that derivatives average to nothing in short runs, too.
inline double weight_of(long n, long steps) {
  return std::pow(std::sin(M_PI * static_cast<double>(n) / static_cast<double>(steps)), 2);
}

// What the bonds of each of these laws would do to one run that does not heat: σ of what is fed, through the law's
// recurrence, at work Σ ½(λ + λ₊)Δσ + ¼(δλ₊ − δλ)|Δr|², A δλ = (σ₊ − 2σ + σ₋)/h². By bond and law.
inline Eigen::MatrixXd foretold_by_bond(const Scene& scene, const std::vector<Law>& laws) {
  const System& sys = scene.system;
  const double h = scene.run.h();
  const int m = sys.bond_count(), all = static_cast<int>(laws.size());
  ForceField forces(sys, scene.start.box, scene.terms);
  Feedforward method(sys, {}, h);
  const Dynamics dynamics{sys, forces, method};
  State s = scene.start;
  initialize(dynamics, h, s);
  DirectSolver solver(sys);
  Vectors r(3, m), r_next(3, m), a = Vectors::Zero(3, sys.atoms()), a_ij(3, m), v_ij(3, m), y(a), y_ij(3, m);
  Eigen::MatrixXd work = Eigen::MatrixXd::Zero(m, all), now = work, before = work, next = work, fed = work;
  Eigen::VectorXd square_before = Eigen::VectorXd::Zero(m), more = square_before;
  std::array<Eigen::VectorXd, 3> past = {more, more, more};
  differences(sys, s.x, r);
  double weights = 0;
  for (long n = 0; n < scene.run.steps; ++n) {
    a = s.f * sys.inv_mass.asDiagonal();
    differences(sys, a, a_ij);
    differences(sys, s.v, v_ij);
    const Eigen::VectorXd lambda = method.lambda();
    for (int l = 0; l < all; ++l) {
      const Law& law = laws[static_cast<std::size_t>(l)];
      fed.col(l) = std::pow(h, 4) / 4 * a_ij.colwise().squaredNorm().transpose();
      if (!law.guess) continue;
      const double discrete = law.damping == Damping::kDiscrete ? 1 : 0;
      const auto [first, second] = limit_to_known(*law.guess, static_cast<int>(std::min(n, 3L)));
      y.setZero();
      add_constraint_acceleration(
          sys, r, past[0] + first * (past[0] - past[1]) + second * (past[1] - past[2]) - lambda, y);
      differences(sys, y, y_ij);
      fed.col(l) = -(1 + law.ah) * std::pow(h, 3) *
                   (v_ij + discrete * 0.5 * h * (a_ij + y_ij)).cwiseProduct(y_ij).colwise().sum().transpose();
    }
    past = {lambda, past[0], past[1]};
    EXPECT_TRUE(step(dynamics, h, s).converged());
    differences(sys, s.x, r_next);
    solver.factor(r);
    const double weight = weight_of(n, scene.run.steps);
    weights += weight;
    const Eigen::VectorXd square = (r_next - r).colwise().squaredNorm();
    for (int l = 0; l < all; ++l) {
      const auto& [ah, bh_squared, guess, damping] = laws[static_cast<std::size_t>(l)];
      next.col(l) = (fed.col(l) + (2 - bh_squared) * now.col(l) - (1 - ah) * before.col(l)) / (1 + ah);
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
  return work / ns / degrees_of_freedom(sys, m, true).total();
}

// By law.
inline Eigen::VectorXd foretold(const Scene& scene, const std::vector<Law>& laws) {
  return foretold_by_bond(scene, laws).colwise().sum();
}

}  // namespace taut::tests
