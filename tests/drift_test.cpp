// Where Baumgarte's energy goes: the closed form of constraints/README.md against runs of a free chain.

#include <gtest/gtest.h>

#include <cmath>

#include "base/statistics.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "constraints/methods/newton.hpp"
#include "constraints/projection.hpp"
#include "free_system.hpp"
#include "md/observables.hpp"

namespace taut::drift_tests {
namespace {

struct Drift {
  double measured = 0;   // of the kinetic energy, the only one, per unit time
  double predicted = 0;  // −αh·h³/(βh)² Σ ⟨λ̇ v·a⟩
};

Baumgarte::Options options_for(double ah, double bh_squared, const char* damping, double h) {
  return {.gains = "numbers",
          .damping = damping,
          .alpha_per_ps = ah / h,
          .beta_per_ps = std::sqrt(bh_squared) / h};
}

template <class Method>
Drift drift_of(Method method, double ah, double bh_squared, double h, double time, std::uint64_t seed = 1) {
  auto [sys, s] = tests::free_chain(20, seed);
  tests::NoForce forces;
  initialize({sys, forces, method}, h, s);
  Slope energy;
  double work = 0;
  Eigen::VectorXd lambda_before = method.lambda(), lambda_now = lambda_before, va(sys.bond_count());
  const int steps = static_cast<int>(std::lround(time / h));
  for (int n = 0; n < steps; ++n) {
    // v·a of the state that lambda_now belongs to
    for (int k = 0; k < sys.bond_count(); ++k) {
      const auto& [i, j, d] = sys.bonds[k];
      const Vec3 a = sys.inv_mass[j] * s.f.col(j) - sys.inv_mass[i] * s.f.col(i);
      va[k] = (s.v.col(j) - s.v.col(i)).dot(a);
    }
    EXPECT_TRUE(step({sys, forces, method}, h, s).converged());
    if (n > 10) work -= (method.lambda() - lambda_before).dot(va) / (2 * h);
    lambda_before = lambda_now;
    lambda_now = method.lambda();
    energy.add(s.t, kinetic_energy(sys, s.v));
  }
  return {energy.value(), work / steps * ah * std::pow(h, 3) / bh_squared};
}

TEST(Drift, OfImplicitDampingIsAsPredicted) {
  for (const double ah : {0.05, 0.2, 1.0})
    for (const double bh_squared : {1.0, 2.0, 3.0}) {
      const double h = 0.01;
      const Drift drift =
          drift_of(Baumgarte(tests::free_chain(20, 1).system, options_for(ah, bh_squared, "implicit", h), h),
                   ah, bh_squared, h, 500);
      EXPECT_NEAR(drift.measured / drift.predicted, 1, 0.1) << "αh " << ah << " (βh)² " << bh_squared;
      EXPECT_GT(drift.measured, 0);  // it heats
    }
}

double implicit_drift(double ah, double h) {
  const System sys = tests::free_chain(20, 1).system;
  return drift_of(Baumgarte(sys, options_for(ah, 2, "implicit", h), h), ah, 2, h, 1000).measured;
}

TEST(Drift, OfImplicitDampingGoesAsAlphaHAndAsTheCubeOfTheStep) {
  EXPECT_NEAR(implicit_drift(0.4, 0.01) / implicit_drift(0.1, 0.01), 4, 0.4);
  EXPECT_NEAR(std::log2(implicit_drift(0.2, 0.02) / implicit_drift(0.2, 0.01)), 3, 0.3);
}

// Damping the centred rate in place of J v takes the irreversible term away, at any gain.
TEST(Drift, OfCentredDampingIsHundredfoldLess) {
  const double h = 0.01;
  const System sys = tests::free_chain(20, 1).system;
  for (const double ah : {0.1, 1.0}) {
    const double implicit =
        drift_of(Baumgarte(sys, options_for(ah, 2, "implicit", h), h), ah, 2, h, 1000).measured;
    const double centred =
        drift_of(Baumgarte(sys, options_for(ah, 2, "centred", h), h), ah, 2, h, 1000).measured;
    EXPECT_LT(std::abs(centred), 0.01 * implicit) << "αh " << ah;
  }
}

TEST(Drift, FeedforwardKeepsEnergyAsRattleDoes) {
  const double h = 0.01;
  const System sys = tests::free_chain(20, 1).system;
  const double rattle = drift_of(Newton(sys, {.tolerance = 1e-12}, h), 0, 1, h, 1000).measured;
  const double ours = drift_of(Baumgarte(sys, Feedforward::Options{}, h), 0, 1, h, 1000).measured;
  const double baumgarte = implicit_drift(1, h);
  EXPECT_LT(std::abs(rattle), 1e-3 * baumgarte);
  EXPECT_LT(std::abs(ours), 1e-3 * baumgarte);
}

}  // namespace
}  // namespace taut::drift_tests
