// Velocity rescaling: what it leaves distributed as, at steps at which motion is barely resolved.

#include <gtest/gtest.h>

#include "base/random.hpp"
#include "constraints/methods/newton.hpp"
#include "constraints/projection.hpp"
#include "ensembles/bussi.hpp"
#include "free_system.hpp"
#include "md/observables.hpp"
#include "md/units.hpp"
#include "md/velocity_verlet.hpp"

namespace taut::thermostat_tests {
namespace {

constexpr double kWarm = 1 / kBoltzmann;  // kT = 1 kJ/mol

// Atoms of unit mass that nothing pushes.
struct FreeAtoms {
  explicit FreeAtoms(int atoms) : sys(make_system(Eigen::VectorXd::Ones(atoms), {})) {
    s.x = s.f = Vectors::Zero(3, atoms);
    s.v = Vectors::Ones(3, atoms);
  }
  System sys;
  State s;
};

// One step from K: ⟨K'⟩ = cK + (1 − c)K̄, c = exp(−h/τ).
TEST(VelocityRescaling, RelaxesInItsTime) {
  auto [sys, s] = FreeAtoms(4);
  const Vectors hot = Vectors::Constant(3, 4, 2.0);
  const double c = std::exp(-0.05 / 0.1), kinetic = kinetic_energy(sys, hot), wanted = 0.5 * 12;
  VelocityRescaling thermostat(sys, {kWarm, 0.1, 12, 3});
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
  for (const int dof : {1, 2, 4, 5, 6}) {
    auto [sys, s] = FreeAtoms(1);
    VelocityRescaling thermostat(sys, {kWarm, 0.01, dof, 4});  // forgotten at once
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
  auto [sys, s] = FreeAtoms(10);
  s.v.setRandom();
  VelocityRescaling thermostat(sys, {kWarm, 0.1, dof, 1});
  double mean = 0, square = 0;
  const int samples = 40000;
  for (int n = 0; n < samples; ++n) {
    for (int k = 0; k < 3; ++k) thermostat.after_step(sys, 0.1, s);
    const double kinetic = kinetic_energy(sys, s.v);
    mean += kinetic / samples;
    square += kinetic * kinetic / samples;
  }
  EXPECT_NEAR(mean / (0.5 * dof), 1, 0.01);
  EXPECT_NEAR((square - mean * mean) / (0.5 * dof), 1, 0.05);
}

// u = P(v + (h/2)M⁻¹f)
Vectors middle_velocity(const System& sys, double h, const State& s) {
  Vectors u = s.v;
  for (int a = 0; a < sys.atoms(); ++a) u.col(a) += 0.5 * h * sys.inv_mass[a] * s.f.col(a);
  Projector(sys).velocities(sys, s.x, u);
  return u;
}

// All of the drift's velocity by one factor, and no other part of v; its heat is what the full step's energy gains.
TEST(VelocityRescaling, ScalesTheVelocityOfTheDriftAlone) {
  auto [sys, s] = tests::free_chain(10, 3);
  Projector(sys).velocities(sys, s.x, s.v);
  s.f.setRandom();
  s.f *= 20;
  const double h = 0.1;
  VelocityRescaling thermostat(sys, {kWarm, 0.2, 21, 5});
  const State before = s;
  const double heat = thermostat.after_step(sys, h, s);
  EXPECT_NEAR(heat, kinetic_energy(sys, s.v) - kinetic_energy(sys, before.v), 1e-12);
  const Vectors u = middle_velocity(sys, h, before), now = middle_velocity(sys, h, s);
  const double scale = now.norm() / u.norm();
  EXPECT_GT(std::abs(scale - 1), 0.01);
  EXPECT_LT((now - scale * u).norm(), 1e-11);
  EXPECT_LT((s.v - before.v - (scale - 1) * u).norm(), 1e-11);
}

// Mean squares over a run in the bath: of the velocities of drifts and of full steps, in units of kT a degree of
// freedom, and of what `watch` returns of the state.
struct Means {
  double middle = 0, full = 0, watched = 0;
};
template <class Watched>
Means in_bath(const System& sys, ForceLaw& forces, State s, int dof, double h, const Watched& watch) {
  Newton method(sys, {}, h);
  VelocityRescaling bath(sys, {kWarm, 5 * h, dof, 2});
  const Dynamics dynamics{sys, forces, method, bath};
  initialize(dynamics, h, s);
  Means mean;
  constexpr int kSteps = 4000, kSettled = 200;
  for (int n = 0; n < kSteps; ++n) {
    EXPECT_TRUE(step(dynamics, h, s).converged());
    if (n < kSettled) continue;
    mean.middle += 2 * kinetic_energy(sys, middle_velocity(sys, h, s)) / dof / (kSteps - kSettled);
    mean.full += 2 * kinetic_energy(sys, s.v) / dof / (kSteps - kSettled);
    mean.watched += watch(s) / (kSteps - kSettled);
  }
  return mean;
}

// ω² = 2
struct Springs : ForceLaw {
  void evaluate(const System&, State& s) override { s.f = -2 * s.x; }
};

// The energy ½v²/m + ½kx²(1 − (ωh)²/4) of full steps is kept. What the bath brings to kT/2, ½m(v − ½hω²x)², is with it
// the mean of ½kx², at any ωh < 2; the full step is colder by 1 − (ωh)²/4.
TEST(VelocityRescaling, IsExactForHarmonicMotionAtALargeStep) {
  constexpr int kAtoms = 100;
  for (const double h : {0.4, 0.8, 1.2}) {
    auto [sys, s] = FreeAtoms(kAtoms);
    Random random(8);
    for (int a = 0; a < kAtoms; ++a) s.v.col(a) = random.normal_vector();
    Springs springs;
    const Means mean = in_bath(sys, springs, s, 3 * kAtoms, h,
                               [](const State& now) { return 2 * now.x.squaredNorm() / (3 * kAtoms); });
    EXPECT_NEAR(mean.middle, 1, 0.02) << h;
    EXPECT_NEAR(mean.watched, 1, 0.02) << h;
    EXPECT_NEAR(mean.full / mean.middle, 1 - h * h / 2, 0.01) << h;
  }
}

// Pendulums of unit length and mass in every direction.
struct Pendulums {
  System sys;
  State s;
  explicit Pendulums(int count) {
    Eigen::VectorXd mass(2 * count);
    std::vector<RigidBond> bonds;
    Random random(9);
    s.x = s.v = s.f = Vectors::Zero(3, 2 * count);
    for (int p = 0; p < count; ++p) {
      mass.segment<2>(2 * p) << 0, 1;
      bonds.push_back({2 * p, 2 * p + 1, 1.0});
      s.x(0, 2 * p + 1) = 1;
      s.v.col(2 * p + 1) = random.normal_vector();
    }
    sys = make_system(mass, bonds);
  }
};

// A rotor turns by θ a step, sin θ = hp: its momentum is that of the tangent, at full steps and between them, and what
// the bath brings to kT. The chord between two positions is longer than the tangent's sin θ, 2 sin ½θ.
TEST(VelocityRescaling, IsExactForFreeRotorsAtALargeStep) {
  constexpr int kRotors = 100;
  constexpr double h = 0.2;
  auto [sys, s] = Pendulums(kRotors);
  tests::NoForce forces;
  Vectors before = s.x;
  const Means mean = in_bath(sys, forces, s, 2 * kRotors, h, [&](const State& now) {
    const double chord = (now.x - before).squaredNorm() / (h * h) / (2 * kRotors);
    before = now.x;
    return chord;
  });
  EXPECT_NEAR(mean.middle, 1, 0.01);
  EXPECT_NEAR(mean.full / mean.middle, 1, 1e-3);
  EXPECT_NEAR(mean.watched / mean.middle, 1 + h * h + 3 * std::pow(h, 4), 0.015);  // ⟨2p²/(1 + cos θ)⟩/⟨p²⟩
}

// In a strong field a rotor swings as an oscillator of ω² = g, but for kT/g.
TEST(VelocityRescaling, IsExactForRotorsThatSwingInAFieldAtALargeStep) {
  constexpr int kRotors = 100;
  constexpr double g = 200, h = 0.07;  // ωh = 0.99
  auto [sys, s] = Pendulums(kRotors);
  tests::UniformForce field{{g, 0, 0}};
  const Means mean = in_bath(sys, field, s, 2 * kRotors, h, [](const State& now) {
    double height = 0;
    for (int p = 0; p < kRotors; ++p) height += 1 - now.x(0, 2 * p + 1);
    return g * height / kRotors;
  });
  EXPECT_NEAR(mean.middle, 1, 0.02);
  EXPECT_NEAR(mean.watched, 1, 0.03);  // kT, two ways to swing
  EXPECT_NEAR(mean.full / mean.middle, 1 - g * h * h / 4, 0.02);
}

}  // namespace
}  // namespace taut::thermostat_tests
