// What feedforward's one solve leaves, and what that does to the energy of water at 2 fs.

#include <gtest/gtest.h>

#include <cmath>

#include "constraints/bond_algebra.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "constraints/projection.hpp"
#include "forcefield/force_field.hpp"
#include "free_system.hpp"
#include "md/observables.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut::feedforward_energy_tests {
namespace {

Eigen::VectorXd residuals(const System& sys, const Vectors& r) {
  Eigen::VectorXd all(sys.bond_count());
  for (int k = 0; k < sys.bond_count(); ++k) all[k] = sigma(r.col(k), sys.bonds[k].length);
  return all;
}

constexpr int kSettling = 300;  // steps in which what the start has left dies away

// The constraints' work −Σ ½(λ₊ − λ₋)σ, summed by parts, so that what merely fluctuates is gone
// [kJ/mol/ns/degree of freedom].
double work(double dt_fs, int steps, const Baumgarte::Options& options) {
  const Scene scene =
      read_scene(find_scene("water"), {"forcefield.switch_nm=0.75", "forcefield.rf_dielectric=1e9"});
  const System& sys = scene.system;
  const double h = dt_fs / 1000;
  ForceField forces(sys, scene.start.box, scene.terms);
  Baumgarte method(sys, options, h);
  const Dynamics dynamics{sys, forces, method};
  State s = scene.start;
  initialize(dynamics, h, s);
  Vectors r(3, sys.bond_count());
  Eigen::VectorXd before = method.lambda(), now = before, left = Eigen::VectorXd::Zero(sys.bond_count());
  double sum = 0;
  for (int n = 0; n < steps; ++n) {
    EXPECT_TRUE(step(dynamics, h, s).converged());
    if (n >= kSettling) sum -= 0.5 * (method.lambda() - before).dot(left);
    before = now;
    now = method.lambda();
    differences(sys, s.x, r);
    left = residuals(sys, r);
  }
  return sum / ((steps - kSettling) * h / 1000) / degrees_of_freedom(sys, sys.bond_count(), 3).total();
}

const Feedforward::Options kOneSolve{.tolerance = 0.1};

// It cools by h¹¹: σ ~ h¹⁰ leans a step and a half late against λ. From 1 to 2 fs that is 10.64 ± 0.08 (13
// starts), as water's fastest turns are not slow beside 2 fs. The default's second solves, where the first
// would leave more than 1e-7, take that away.
TEST(FeedforwardEnergy, OneSolveCoolsWaterByTheEleventhPowerOfTheStep) {
  const double whole = work(2, 1500, kOneSolve), half = work(1, 3000, kOneSolve);
  EXPECT_NEAR(whole, -0.0135, 0.003);
  EXPECT_NEAR(std::log2(whole / half), 10.64, 0.4);
  EXPECT_LT(std::abs(work(2, 1500, Feedforward::Options{})), 0.05 * std::abs(whole));
}

// What is left, g = ½|h²M⁻¹JᵀΔλ|² of a third difference, is a step and a half late, and the law makes of it (1 + αh)/(βh)²,
// another 2αh/(βh)² of a step late: work goes as (1 + αh)/(βh)² (3/2 + 2αh/(βh)²), 5/2 at dead-beat.
TEST(FeedforwardEnergy, GainsScaleTheWorkByTheirFilterAndItsLag) {
  const double h = 0.001, dead_beat = work(1, 3000, kOneSolve);
  for (const auto& [ah, bh2] : {std::pair{0.3, 2.5}, {0.1, 2.0}, {1.0, 0.8}}) {
    const double ours = work(
        1, 3000,
        {.gains = "numbers", .alpha_per_ps = ah / h, .beta_per_ps = std::sqrt(bh2) / h, .tolerance = 0.1});
    EXPECT_NEAR(ours / dead_beat / ((1 + ah) / bh2 * (1.5 + 2 * ah / bh2) / 2.5), 1, 0.16)
        << ah << " " << bh2;
  }
}

}  // namespace
}  // namespace taut::feedforward_energy_tests
