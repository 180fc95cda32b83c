#pragma once

// The work that a law's bonds would do, found along a run of feedforward, which does none.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>

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

// What a law's bonds would do to a run that does not heat: σ of what is fed, through the law's recurrence, at
// work Σ ½(λ + λ₊)Δσ + ¼(δλ₊ − δλ)|Δr|², A δλ = (σ₊ − 2σ + σ₋)/h². By bond.
inline Eigen::VectorXd foretold_by_bond(const Scene& scene, const Law& law) {
  const System& sys = scene.system;
  const double h = scene.run.h();
  const int m = sys.bond_count();
  const double discrete = law.damping == Damping::kDiscrete ? 1 : 0;
  ForceField forces(sys, scene.start.box, scene.terms);
  Feedforward method(sys, {}, h);
  const Dynamics dynamics{sys, forces, method};
  State s = scene.start;
  initialize(dynamics, h, s);
  DirectSolver solver(sys);
  Vectors r(3, m), r_next(3, m), a = Vectors::Zero(3, sys.atoms()), a_ij(3, m), v_ij(3, m), y(a), y_ij(3, m);
  Eigen::VectorXd now = Eigen::VectorXd::Zero(m), before = now, next = now, square_before = now, fed = now;
  std::array<Eigen::VectorXd, 3> past = {now, now, now};
  differences(sys, s.x, r);
  Eigen::VectorXd work = Eigen::VectorXd::Zero(m);
  constexpr long kSettle = 50;
  for (long n = 0; n < scene.run.steps; ++n) {
    a = s.f * sys.inv_mass.asDiagonal();
    differences(sys, a, a_ij);
    differences(sys, s.v, v_ij);
    const Eigen::VectorXd lambda = method.lambda();
    fed = std::pow(h, 4) / 4 * a_ij.colwise().squaredNorm().transpose();
    if (law.guess) {
      const auto [first, second] = limit_to_known(*law.guess, static_cast<int>(std::min(n, 3L)));
      y.setZero();
      add_constraint_acceleration(
          sys, r, past[0] + first * (past[0] - past[1]) + second * (past[1] - past[2]) - lambda, y);
      differences(sys, y, y_ij);
      fed = -(1 + law.ah) * std::pow(h, 3) *
            (v_ij + discrete * 0.5 * h * (a_ij + y_ij)).cwiseProduct(y_ij).colwise().sum().transpose();
    }
    past = {lambda, past[0], past[1]};
    EXPECT_TRUE(step(dynamics, h, s).converged());
    differences(sys, s.x, r_next);
    next = (fed + (2 - law.bh_squared) * now - (1 - law.ah) * before) / (1 + law.ah);
    Eigen::VectorXd more = (next - 2 * now + before) / (h * h);  // δλ
    solver.factor(r);
    solver.solve(more);
    const Eigen::VectorXd square = (r_next - r).colwise().squaredNorm();
    if (n > kSettle)
      work += 0.5 * (lambda + method.lambda()).cwiseProduct(next - now) -
              0.25 * more.cwiseProduct(square - square_before);
    square_before = square;
    before = now;
    now = next;
    r = r_next;
  }
  const double ns = static_cast<double>(scene.run.steps - kSettle - 1) * h / 1000;
  return work / ns / degrees_of_freedom(sys, m, true).total();
}

inline double foretold(const Scene& scene, const Law& law) {
  return foretold_by_bond(scene, law).sum();
}

}  // namespace taut::tests
