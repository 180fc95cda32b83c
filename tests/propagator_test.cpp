#include "constraints/methods/propagator.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/errors.hpp"
#include "constraints/bond_algebra.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "constraints/projection.hpp"
#include "free_system.hpp"

namespace taut::propagator_tests {
namespace {

using tests::NoForce;

Baumgarte::Options options_for(double ah, double bh, Damping damping, double h) {
  return {.gains = "numbers",
          .damping = std::string(name_of(damping)),
          .alpha_per_ps = ah / h,
          .beta_per_ps = bh / h,
          .tolerance = 1e-14};
}

double sigma_of(const System& sys, const State& s) {
  return sigma(s.x.col(1) - s.x.col(0), sys.bonds[0].length);
}

// One bond at rest, stretched by 1e-8: the errors of the next steps.
std::vector<double> errors_of_a_bond_at_rest(double ah, double bh, Damping damping, int steps) {
  const double h = 0.01;
  auto [sys, s] = tests::rotor(0);
  Baumgarte method(sys, options_for(ah, bh, damping, h), h);
  NoForce forces;
  initialize({sys, forces, method}, h, s);
  s.x(0, 1) += 1e-8;
  std::vector<double> errors = {sigma_of(sys, s)};
  for (int n = 0; n < steps; ++n) {
    EXPECT_TRUE(step({sys, forces, method}, h, s).converged());
    errors.push_back(sigma_of(sys, s));
  }
  return errors;
}

TEST(Propagator, IsWhatABondDoes) {
  for (const Damping damping : kDampings)
    for (const double ah : {0.05, 0.3, 0.6})
      for (const double bh : {0.3, 1.0, 1.2}) {
        const Propagator propagator(ah, bh, damping);
        const auto errors = errors_of_a_bond_at_rest(ah, bh, damping, 12);
        for (int n = 2; n <= 12; ++n) {
          const double recurrence = propagator.trace * errors[n - 1] - propagator.determinant * errors[n - 2];
          EXPECT_NEAR(errors[n], recurrence, 3e-14)
              << name_of(damping) << " αh " << ah << " βh " << bh << " step " << n;
          EXPECT_NEAR(errors[n], propagator.residual(errors[0], errors[1], n), 3e-14);
        }
      }
}

TEST(Propagator, RootsSolveTheirEquation) {
  for (const Damping damping : kDampings)
    for (const double ah : {0.0, 0.2, 0.5, 1.0, 3.0})
      for (const double bh : {0.1, 1.0, 1.9}) {
        const Propagator p(ah, bh, damping);
        for (const auto z : p.roots()) EXPECT_LT(std::abs(z * z - p.trace * z + p.determinant), 1e-12);
        EXPECT_GE(std::abs(p.roots()[0]), std::abs(p.roots()[1]) - 1e-12);
      }
}

TEST(Propagator, WantedRootsAreFound) {
  for (const Damping damping : kDampings)
    for (const double r : {0.0, 0.2, 0.5, 0.9, 0.99}) {
      const auto both = gains_for_root(r, damping);
      const Propagator p(both.ah, both.bh, damping);
      EXPECT_NEAR(p.trace, 2 * r, 1e-14);
      EXPECT_NEAR(p.determinant, r * r, 1e-14);
      const auto one = gains_for_decay(r, damping);
      const Propagator q(one.ah, one.bh, damping);
      EXPECT_NEAR(q.trace, r, 1e-14);
      EXPECT_NEAR(q.determinant, 0, 1e-14);
      const auto swept = gains_for_sweeps(r, damping);
      const Propagator s(swept.ah, swept.bh, damping);
      EXPECT_NEAR(s.trace, r + r * r, 1e-14);
      EXPECT_NEAR(s.determinant, r * r, 1e-14);
    }
}

TEST(Propagator, DeadBeatClearsAnErrorInTwoSteps) {
  for (const Damping damping : kDampings) {
    const auto [ah, bh] = gains_for_root(0, damping);
    const auto errors = errors_of_a_bond_at_rest(ah, bh, damping, 3);
    EXPECT_GT(std::abs(errors[1]), 0.9e-8);  // the kick already under way knew nothing of it
    EXPECT_LT(std::abs(errors[2]), 1e-14);
    EXPECT_LT(std::abs(errors[3]), 1e-14);
  }
}

// The largest βh at which a bond's own run does not grow, by bisection. Gains beyond the limit are refused,
// so the run is one of a method made for a step a third as long: αh and βh then grow with the step it is run
// at.
TEST(Propagator, StabilityLimitIsWhereARunBlowsUp) {
  const double h = 0.01;
  for (const Damping damping : kDampings)
    for (const double ah : {0.1, 0.5, 0.8}) {
      const auto grows = [&](double bh) {
        auto [sys, s] = tests::rotor(0);
        Baumgarte method(sys, options_for(ah / 3, bh / 3, damping, h / 3), h / 3);
        NoForce forces;
        initialize({sys, forces, method}, h, s);
        s.x(0, 1) += 1e-9;
        for (int n = 0; n < 1500; ++n)
          if (!step({sys, forces, method}, h, s).converged()) return true;
        return !(std::abs(sigma_of(sys, s)) < 1e-9);
      };
      double low = 0.01, high = 3;
      while (high - low > 1e-3) (grows(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
      EXPECT_NEAR(low / stability_limit(ah, damping), 1, 0.02) << name_of(damping) << " αh " << ah;
    }
}

TEST(Propagator, BeyondTheLimitGainsAreRefused) {
  const double h = 0.01;
  const System sys = tests::rotor(0).system;
  for (const Damping damping : kDampings) {
    const double limit = stability_limit(0.5, damping);
    EXPECT_NO_THROW(Baumgarte(sys, options_for(0.5, 0.99 * limit, damping, h), h));
    EXPECT_THROW(Baumgarte(sys, options_for(0.5, 1.01 * limit, damping, h), h), InputError);
    EXPECT_THROW(Baumgarte(sys, options_for(-0.1, 1, damping, h), h), InputError);
  }
  EXPECT_THROW(Baumgarte(sys, options_for(1.1, 0.1, Damping::kLagged, h), h), InputError);
}

// A free rotor turning by θ a step: |v| = θd/h, |a| = θ²d/h², v·a = 0, so that σ/d² settles at θ⁴/4/(βh)²,
// and δd/d = θ⁴/8 at (βh)² = 2; under lagged damping at −αh θ²/(βh)² instead.
TEST(Floor, OfAFreeRotor) {
  const double h = 0.01;
  for (const double theta : {0.05, 0.1})
    for (const Damping damping : kDampings) {
      const double ah = 0.4, bh = 1.2;
      auto [sys, s] = tests::rotor(theta / h);
      Baumgarte method(sys, options_for(ah, bh, damping, h), h);
      NoForce forces;
      initialize({sys, forces, method}, h, s);
      for (int n = 0; n < 400; ++n) EXPECT_TRUE(step({sys, forces, method}, h, s).converged());
      const Vec3 v = theta / h * Vec3::UnitX(), a = theta * theta / (h * h) * Vec3::UnitY();
      const double predicted = Law(ah, bh, h, damping).floor(v - 0.5 * h * a, a);
      if (damping == Damping::kDiscrete) {
        EXPECT_EQ(predicted, 0);
        EXPECT_LT(std::abs(sigma_of(sys, s)), 1e-6 * std::pow(theta, 4));
        continue;
      }
      EXPECT_NEAR(sigma_of(sys, s) / predicted, 1, 0.02) << name_of(damping) << " θ " << theta;
    }
  const auto [ah, bh] = gains_for_root(0, Damping::kCentred);
  const Vec3 a = std::pow(0.1 / h, 2) * Vec3::UnitX();
  EXPECT_NEAR(Law(ah, bh, h, Damping::kCentred).floor(Vec3::Zero(), a), 1e-4 / 8, 1e-12);
}

// The formulas of propagator.hpp, with vectors.
TEST(Floor, IsWhatIsSaidOfEachDamping) {
  const double ah = 0.3, bh = 1.2, h = 0.1;
  const Vec3 v(1, 2, -0.5), a(-3, 1, 4);
  const double fed = std::pow(h, 4) * a.squaredNorm() / 4;
  const auto floor = [&](Damping damping) { return Law(ah, bh, h, damping).floor(v - 0.5 * h * a, a); };
  EXPECT_NEAR(floor(Damping::kCentred), fed / (bh * bh), 1e-15);
  EXPECT_NEAR(floor(Damping::kImplicit), (fed + ah * h * h * h * v.dot(a)) / (bh * bh), 1e-15);
  EXPECT_NEAR(floor(Damping::kLagged), (fed - ah * h * h * (v - 0.5 * h * a).squaredNorm()) / (bh * bh),
              1e-15);
}

// How a bond at rest gets its stretch: its atoms are moved between two steps, or the method starts from
// there.
enum class Stretched { kBetweenSteps, kFromTheStart };

// The smallest stretch from which a bond at rest does not come back, (βh)² = bh2; to 6 %. sign −1:
// compressed.
double bearable_stretch(double ah, double bh2, const char* damping, Stretched how = Stretched::kBetweenSteps,
                        double sign = 1) {
  const double h = 0.01;
  const auto comes_back = [&](double stretch) {
    auto [sys, s] = tests::rotor(0);
    Baumgarte method(sys,
                     {.gains = "numbers",
                      .damping = damping,
                      .alpha_per_ps = ah / h,
                      .beta_per_ps = std::sqrt(bh2) / h,
                      .tolerance = 1e-14},
                     h);
    NoForce forces;
    initialize({sys, forces, method}, h, s);
    s.x(0, 1) += sign * stretch;
    if (how == Stretched::kFromTheStart) {
      forces.evaluate(sys, s);
      EXPECT_TRUE(method.add_forces(sys, Push::at_start(h), s).converged());
    }
    for (int n = 0; n < 3000; ++n)
      if (!step({sys, forces, method}, h, s).converged() || !(std::abs(s.x(0, 1) - s.x(0, 0) - 1) < 0.5))
        return false;
    return true;
  };
  double stretch = 5e-4;
  while (stretch < 0.5 && comes_back(stretch)) stretch *= 1.06;
  return stretch;
}

// A third of a turn a step, (βh)² = 3: ¼h⁴|a|² is quadratic in σ and turns twice as far, which is the same
// the other way round. Its amplitude, ΔA = −αh A − i (9/4)/(2 sin 120°) Ā²/d², grows from 0.93 αh on where
// atoms are moved between two steps, from twice that where the method starts from the stretch, in another
// phase; elsewhere little damping is enough.
TEST(Propagator, AThirdOfATurnResonates) {
  for (const double ah : {0.01, 0.02, 0.05}) {
    EXPECT_NEAR(bearable_stretch(ah, 3, "centred") / ah, 0.93, 0.07) << ah;
    EXPECT_GT(bearable_stretch(ah, 3, "centred", Stretched::kFromTheStart), 1.6 * ah) << ah;
    EXPECT_GT(bearable_stretch(ah, 2, "centred"), 0.2) << ah;
    EXPECT_GT(bearable_stretch(ah, 2.5, "centred"), 0.15) << ah;
  }
}

// The discrete law has no drive, and bears it at all gains.
TEST(Propagator, AThirdOfATurnLeavesTheDiscreteLawAlone) {
  for (const double ah : {0.01, 0.05}) EXPECT_GT(bearable_stretch(ah, 3, "discrete"), 0.12) << ah;
}

}  // namespace
}  // namespace taut::propagator_tests
