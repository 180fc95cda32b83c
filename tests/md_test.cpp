#include <gtest/gtest.h>

#include "constraints/gaps.hpp"
#include "md/errors.hpp"
#include "md/nearest_name.hpp"
#include "md/observables.hpp"
#include "md/run.hpp"
#include "md/thermostat.hpp"
#include "md/units.hpp"

namespace taut {
namespace {

System particle(double mass = 1) {
  return make_system(Eigen::VectorXd::Constant(1, mass), {});
}

State at_rest(int atoms) {
  State s;
  s.x = s.v = s.f = Vectors::Zero(3, atoms);
  return s;
}

struct Spring {  // of constant 1, to the origin
  void operator()(const System&, State& s) const { s.f = -s.x; }
};

double oscillator_error(double h) {
  const System sys = particle();
  State s = at_rest(1);
  s.x(0, 0) = 1;
  Spring forces;
  EmptyGaps free;
  forces(sys, s);
  while (s.t < 1 - h / 2) step(sys, forces, free, h, s);
  return std::hypot(s.x(0, 0) - std::cos(s.t), s.v(0, 0) + std::sin(s.t));
}

TEST(Step, IsOfSecondOrder) {
  EXPECT_NEAR(oscillator_error(0.01) / oscillator_error(0.005), 4, 0.02);
}

TEST(Step, IsReversible) {
  const System sys = particle();
  State s = at_rest(1);
  s.x.col(0) << 1, 0.5, -0.3;
  const Vectors start = s.x;
  Spring forces;
  EmptyGaps free;
  forces(sys, s);
  for (int n = 0; n < 900; ++n) step(sys, forces, free, 0.05, s);
  EXPECT_GT((s.x - start).norm(), 0.5);
  s.v = -s.v;
  for (int n = 0; n < 900; ++n) step(sys, forces, free, 0.05, s);
  EXPECT_LT((s.x - start).norm(), 1e-12);
}

TEST(Step, AnAnchorDoesNotMove) {
  const System sys = particle(0);
  State s = at_rest(1);
  s.x(0, 0) = 1;
  Spring forces;
  EmptyGaps free;
  forces(sys, s);
  for (int n = 0; n < 10; ++n) step(sys, forces, free, 0.1, s);
  EXPECT_EQ(s.x(0, 0), 1);
}

std::string refusal(Eigen::VectorXd mass, std::vector<RigidBond> bonds) {
  try {
    make_system(std::move(mass), std::move(bonds));
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(System, RefusesBondsThatMakeNoSense) {
  const Eigen::VectorXd two = Eigen::VectorXd::Ones(2);
  EXPECT_EQ(refusal(two, {{0, 1, 1}}), "accepted");
  EXPECT_NE(refusal(two, {{0, 2, 1}}).find("atom 2 is out of range"), std::string::npos);
  EXPECT_NE(refusal(two, {{-1, 1, 1}}).find("atom -1 is out of range"), std::string::npos);
  EXPECT_NE(refusal(two, {{1, 1, 1}}).find("to itself"), std::string::npos);
  EXPECT_NE(refusal(two, {{0, 1, 0}}).find("length 0"), std::string::npos);
  EXPECT_NE(refusal(two, {{0, 1, 1}, {1, 0, 1}}).find("bond 1 (1-0): repeats bond 0"), std::string::npos);
  EXPECT_NE(refusal(Eigen::VectorXd::Zero(2), {{0, 1, 1}}).find("both ends are anchored"), std::string::npos);
  EXPECT_NE(refusal(-two, {}).find("mass -1"), std::string::npos);
}

TEST(Box, NearestImageIsTheShortest) {
  const Box box{Vec3(2, 3, 4)};
  EXPECT_LT((box.nearest_image(Vec3(1.9, -1.6, 6.5)) - Vec3(-0.1, 1.4, -1.5)).norm(), 1e-14);
  EXPECT_EQ(Box{}.nearest_image(Vec3(9, 9, 9)), Vec3(9, 9, 9));
}

TEST(DegreesOfFreedom, SpellsItsSum) {
  const System sys = make_system(Eigen::VectorXd::Ones(3), {{0, 1, 1}});
  const auto dof = degrees_of_freedom(sys, 1, true);
  EXPECT_EQ(dof.total(), 5);
  EXPECT_EQ(dof.sum(), "3·3 − 1 − 3 = 5");
  Eigen::VectorXd anchored(2);
  anchored << 0, 1;
  const auto pendulum = degrees_of_freedom(make_system(anchored, {{0, 1, 1}}), 1, true);
  EXPECT_EQ(pendulum.total(), 2);  // an anchor takes up momentum
}

TEST(Observables, MomentumIsRemovedFromWhatCanMove) {
  Eigen::VectorXd mass(3);
  mass << 0, 1, 3;
  const System sys = make_system(mass, {});
  Vectors v = Vectors::Random(3, 3);
  v.col(0).setZero();
  remove_momentum(sys, v);
  EXPECT_LT(momentum(sys, v).norm(), 1e-14);
  EXPECT_EQ(v.col(0), Vec3::Zero());
}

TEST(Observables, WorstBondErrorIsFound) {
  const System sys = make_system(Eigen::VectorXd::Ones(3), {{0, 1, 1}, {1, 2, 2}});
  Vectors x = Vectors::Zero(3, 3);
  x(0, 1) = 1;
  x(0, 2) = 3.2;
  const auto e = bond_errors(sys, x);
  EXPECT_EQ(e.worst, 1);
  EXPECT_NEAR(e.max, 0.1, 1e-14);
  EXPECT_NEAR(e.rms, 0.1 / std::sqrt(2.0), 1e-14);
}

TEST(Slope, FitsALineAndItsUncertainty) {
  Slope exact, noisy;
  Random random(5);
  for (int n = 0; n < 400; ++n) {
    exact.add(1e6 + n, 3 + 0.25 * n);
    noisy.add(n, 2.0 * n + random.normal());
  }
  EXPECT_NEAR(exact.value(), 0.25, 1e-12);
  EXPECT_LT(exact.standard_error(), 1e-6);
  const double expected = 1 / std::sqrt(400.0 * (400.0 * 400 - 1) / 12);
  EXPECT_NEAR(noisy.standard_error() / expected, 1, 0.15);
  EXPECT_LT(std::abs(noisy.value() - 2), 4 * expected);
}

struct Runaway {
  void operator()(const System&, State& s) const { s.f = 1e200 * (s.x.array() * s.x.array()).matrix(); }
};

TEST(Run, StopsBeforeNaNAndSaysWhen) {
  const System sys = particle();
  State s = at_rest(1);
  s.x(0, 0) = 1;
  Runaway forces;
  EmptyGaps free;
  Course course;
  try {
    run(
        sys, forces, free, {.h = 1, .steps = 100, .observe_every = 1}, course, s, [](State&) {},
        [](const Moment&) {}, [](long) { return true; });
    FAIL() << "ran on";
  } catch (const SimulationFailure& e) {
    EXPECT_NE(std::string(e.what()).find("step "), std::string::npos);
    EXPECT_NE(std::string(e.what()).find("largest force"), std::string::npos);
  }
}

// Sampled velocities of 10 free particles: mean and variance of the kinetic energy are canonical.
TEST(VelocityRescaling, GivesTheCanonicalKineticEnergy) {
  const int dof = 30;
  const double kT = kBoltzmann * 300;
  const System sys = make_system(Eigen::VectorXd::Ones(10), {});
  Vectors v = Vectors::Random(3, 10);
  VelocityRescaling thermostat(300, 0.1, dof, 1);
  double mean = 0, square = 0;
  const int samples = 40000;
  for (int n = 0; n < samples; ++n) {
    for (int k = 0; k < 3; ++k) thermostat(sys, 0.1, v);
    const double kinetic = kinetic_energy(sys, v);
    mean += kinetic / samples;
    square += kinetic * kinetic / samples;
  }
  EXPECT_NEAR(mean / (0.5 * dof * kT), 1, 0.01);
  EXPECT_NEAR((square - mean * mean) / (0.5 * dof * kT * kT), 1, 0.05);
}

TEST(NearestName, SuggestsTheFewestEdits) {
  EXPECT_EQ(nearest_name("temprature", {"tension", "temperature", "steps"}), "temperature");
  EXPECT_EQ(nearest_name("ratle", {"rattle", "shake"}), "rattle");
  EXPECT_EQ(nearest_name("dt_sf", {"dt_ps", "dt_fs"}), "dt_fs");  // a swap is one
}

TEST(NearestName, SuggestsNothingFarOff) {
  EXPECT_EQ(nearest_name("abcXYf", {"abcdef"}), "abcdef");
  EXPECT_EQ(nearest_name("abXYZf", {"abcdef"}), "");  // 3 of 6
  EXPECT_EQ(nearest_name("ax", {"ab"}), "ab");        // 1 of 2
  EXPECT_EQ(nearest_name("xy", {"ab"}), "");
  EXPECT_EQ(nearest_name("passes", {"name"}), "");
  EXPECT_EQ(nearest_name("temp", {"steps", "temperature_k"}), "temperature_k");  // goes on from it
  EXPECT_EQ(nearest_name("", {"ab"}), "");
  EXPECT_EQ(nearest_name("ab", {}), "");
}

TEST(NearestName, WhereNoneIsNearAllAreNamed) {
  EXPECT_EQ(did_you_mean("shak", {"rattle", "shake"}), "; did you mean \"shake\"?");
  EXPECT_EQ(did_you_mean("lincs", {"rattle", "shake"}), "; expected one of rattle, shake");
  EXPECT_EQ(did_you_mean("lincs", {}), "");
}

}  // namespace
}  // namespace taut
