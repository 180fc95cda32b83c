#include <gtest/gtest.h>

#include "ensembles/bussi.hpp"
#include "md/observables.hpp"
#include "md/units.hpp"

namespace taut::thermostat_tests {
namespace {

// One step from K: ⟨K'⟩ = cK + (1 − c)K̄, c = exp(−h/τ).
TEST(VelocityRescaling, RelaxesInItsTime) {
  const System sys = make_system(Eigen::VectorXd::Ones(4), {});
  const Vectors hot = Vectors::Constant(3, 4, 2.0);
  const double c = std::exp(-0.05 / 0.1), kinetic = kinetic_energy(sys, hot), wanted = 0.5 * 12;
  VelocityRescaling thermostat(sys, {1 / kBoltzmann, 0.1, 12, 3});  // kT = 1
  State s;
  double mean = 0;
  constexpr int kSamples = 20000;
  for (int n = 0; n < kSamples; ++n) {
    s.v = hot;
    const double heat = thermostat.after_step(sys, 0.05, s);
    ASSERT_NEAR(heat, kinetic_energy(sys, s.v) - kinetic, 1e-12);
    mean += kinetic_energy(sys, s.v) / kSamples;
  }
  EXPECT_NEAR(mean, c * kinetic + (1 - c) * wanted, 0.15);
}

// The law of few degrees of freedom, whose squares are summed one by one, and of more, drawn at once.
TEST(VelocityRescaling, IsCanonicalForFewDegreesOfFreedom) {
  const System sys = make_system(Eigen::VectorXd::Ones(1), {});
  for (const int dof : {1, 2, 4, 5, 6}) {
    VelocityRescaling thermostat(sys, {1 / kBoltzmann, 0.01, dof, 4});  // forgotten at once
    State s;
    s.v = Vectors::Ones(3, 1);
    double mean = 0, square = 0;
    constexpr int kSamples = 40000;
    for (int n = 0; n < kSamples; ++n) {
      thermostat.after_step(sys, 1, s);
      const double kinetic = kinetic_energy(sys, s.v);
      mean += kinetic / kSamples;
      square += kinetic * kinetic / kSamples;
    }
    EXPECT_NEAR(mean / (0.5 * dof), 1, 0.03) << dof;
    EXPECT_NEAR((square - mean * mean) / (0.5 * dof), 1, 0.08) << dof;
  }
}

// Sampled velocities of 10 free particles: mean and variance of the kinetic energy are canonical.
TEST(VelocityRescaling, GivesTheCanonicalKineticEnergy) {
  const int dof = 30;
  const double kT = kBoltzmann * 300;
  const System sys = make_system(Eigen::VectorXd::Ones(10), {});
  State s;
  s.v = Vectors::Random(3, 10);
  VelocityRescaling thermostat(sys, {300, 0.1, dof, 1});
  double mean = 0, square = 0;
  const int samples = 40000;
  for (int n = 0; n < samples; ++n) {
    for (int k = 0; k < 3; ++k) thermostat.after_step(sys, 0.1, s);
    const double kinetic = kinetic_energy(sys, s.v);
    mean += kinetic / samples;
    square += kinetic * kinetic / samples;
  }
  EXPECT_NEAR(mean / (0.5 * dof * kT), 1, 0.01);
  EXPECT_NEAR((square - mean * mean) / (0.5 * dof * kT * kT), 1, 0.05);
}

}  // namespace
}  // namespace taut::thermostat_tests
