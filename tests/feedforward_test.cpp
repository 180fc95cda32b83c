// feedforward: Baumgarte's law with dead-beat gains.

#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "constraints/batch/batched_baumgarte.hpp"
#include "constraints/bond_algebra.hpp"
#include "constraints/methods/newton.hpp"
#include "error_message.hpp"
#include "free_system.hpp"
#include "verifier.hpp"

namespace taut::feedforward_tests {
namespace {

using tests::NoForce;
using tests::verify;

// A pendulum of unit mass and length from horizontal: its bond force swings, nothing is constant.
struct Pendulum {
  System system;
  State state;
  tests::UniformForce forces{Vec3(0, 0, -9.81)};
};

Pendulum pendulum() {
  Eigen::VectorXd mass(2);
  mass << 0, 1;
  Pendulum p{make_system(mass, {{0, 1, 1.0}}), {}};
  p.state.x = p.state.v = p.state.f = Vectors::Zero(3, 2);
  p.state.x(0, 1) = 1;
  return p;
}

TEST(Feedforward, FirstStepIsAsGoodAsTheOthers) {
  Pendulum p = pendulum();
  p.state.v(2, 1) = -2;
  Baumgarte method(p.system, Feedforward::Options{.tolerance = 1e-14}, 0.02);
  initialize({p.system, p.forces, method}, 0.02, p.state);
  EXPECT_TRUE(step({p.system, p.forces, method}, 0.02, p.state).converged());
  EXPECT_LT(bond_errors(p.system, p.state.x).max, 1e-14);
}

// Positions are SHAKE's, and so RATTLE's.
TEST(Feedforward, PositionsAreRattles) {
  NoForce forces;
  const auto start = tests::free_chain(10, 6);
  const auto ours =
      verify(start.system, forces, Feedforward::Options{.tolerance = 1e-14}, 0.01, 50, start.state);
  const auto rattle =
      verify(start.system, forces, Newton::Options{.tolerance = 1e-14}, 0.01, 50, start.state);
  EXPECT_LT((ours.end.x - rattle.end.x).cwiseAbs().maxCoeff(), 1e-11);
}

// J v = −½h² v·a for velocities that are the mean of leap-frog's.
TEST(Feedforward, VelocitiesAreLeapFrogsMean) {
  Pendulum p = pendulum();
  const double h = 0.01;
  Baumgarte method(p.system, Feedforward::Options{.tolerance = 1e-14}, h);
  initialize({p.system, p.forces, method}, h, p.state);
  for (int n = 0; n < 30; ++n) EXPECT_TRUE(step({p.system, p.forces, method}, h, p.state).converged());
  const Vec3 r = p.state.x.col(1), v = p.state.v.col(1), a = p.state.f.col(1);
  EXPECT_NEAR(r.dot(v), -0.5 * h * h * v.dot(a), 1e-12);
  EXPECT_GT(std::abs(r.dot(v)), 1e-5);
}

// An injected error is gone in two steps: the kick under way knew nothing of it, the next does.
TEST(Feedforward, ClearsAnInjectedErrorInTwoSteps) {
  Pendulum p = pendulum();
  Baumgarte method(p.system, Feedforward::Options{.tolerance = 1e-14}, 0.01);
  initialize({p.system, p.forces, method}, 0.01, p.state);
  for (int n = 0; n < 10; ++n) EXPECT_TRUE(step({p.system, p.forces, method}, 0.01, p.state).converged());
  p.state.x.col(1) *= 1 + 1e-4;
  EXPECT_TRUE(step({p.system, p.forces, method}, 0.01, p.state).converged());
  EXPECT_GT(bond_errors(p.system, p.state.x).max, 0.5e-4);
  EXPECT_TRUE(step({p.system, p.forces, method}, 0.01, p.state).converged());
  EXPECT_LT(bond_errors(p.system, p.state.x).max, 1e-13);
}

// A blow between two steps makes the extrapolation useless: that step, and only that, takes more solves.
TEST(Feedforward, TakesASecondSolveAtACollisionOnly) {
  Pendulum p = pendulum();
  Baumgarte method(p.system, Feedforward::Options{.tolerance = 1e-5}, 0.005);
  initialize({p.system, p.forces, method}, 0.005, p.state);
  for (int n = 0; n < 20; ++n) EXPECT_EQ(step({p.system, p.forces, method}, 0.005, p.state).iterations, 1);
  p.state.v(2, 1) -= 8;
  EXPECT_GT(step({p.system, p.forces, method}, 0.005, p.state).iterations, 1);
  for (int n = 0; n < 3; ++n) EXPECT_TRUE(step({p.system, p.forces, method}, 0.005, p.state).converged());
  EXPECT_EQ(step({p.system, p.forces, method}, 0.005, p.state).iterations, 1);
  EXPECT_LT(bond_errors(p.system, p.state.x).max, 1e-5);
}

// λ is found before a thermostat rescales the velocities: the next step is off by ½h²(c² − 1)|v|², the one
// after is not.
TEST(Feedforward, IsOffForAStepWhereVelocitiesAreRescaled) {
  const double h = 0.01, c = 1.01, omega = 3;
  const auto start = tests::rotor(omega);
  State s = start.state;
  NoForce forces;
  Baumgarte method(start.system, Feedforward::Options{}, h);
  initialize({start.system, forces, method}, h, s);
  for (int n = 0; n < 10; ++n) EXPECT_TRUE(step({start.system, forces, method}, h, s).converged());
  s.v *= c;
  EXPECT_TRUE(step({start.system, forces, method}, h, s).converged());
  const double off = bond_errors(start.system, s.x).max;  // of the length: σ/d²
  EXPECT_NEAR(off / (0.5 * h * h * (c * c - 1) * omega * omega), 1, 0.02);
  EXPECT_TRUE(step({start.system, forces, method}, h, s).converged());
  EXPECT_LT(bond_errors(start.system, s.x).max, 1e-4 * off);
}

// Sideways so fast that |σ_next| is over 10³·|r_next·r|: no force along the bond brings it back.
TEST(Feedforward, SaysThatBondsRunAway) {
  const auto start = tests::rotor(6000);  // 60 lengths a step
  const auto failure = [&](auto method) -> std::string {
    NoForce forces;
    State s = start.state;
    return error_message<SimulationFailure>([&] { initialize({start.system, forces, method}, 0.01, s); });
  };
  for (const std::string& said : {failure(Baumgarte(start.system, Feedforward::Options{}, 0.01)),
                                  failure(Batched<Baumgarte>(start.system, Feedforward::Options{}, 0.01))}) {
    EXPECT_NE(said.find("the bonds run away"), said.npos) << said;
    EXPECT_NE(said.find("bond 0"), said.npos) << said;
  }
}

// A free rotor whose full-step velocity is ω: the step turns it by θ, sin θ = ωh, and there is no such turn,
// nor any force along the bond that would make one, beyond ωh = 1, θ = 90°. Up to there the step holds it;
// beyond, it says so.
TEST(Feedforward, HoldsARotorUpToARightAngle) {
  const auto verdict_at = [](double omega_h) {
    const auto start = tests::rotor(omega_h / 0.01);
    NoForce forces;
    return verify(start.system, forces, Feedforward::Options{}, 0.01, 200, start.state);
  };
  const auto held = verdict_at(0.98);
  EXPECT_TRUE(held.stats.converged());
  EXPECT_LT(held.bond_error, 1e-5);
  EXPECT_THROW(verdict_at(1.02), SimulationFailure);  // at the start
}

}  // namespace
}  // namespace taut::feedforward_tests
