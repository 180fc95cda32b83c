// Incompressibility held as bonds are: by the same recurrence.

#include "studies/flow.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "constraints/methods/propagator.hpp"

namespace taut::flow_tests {
namespace {

double rms(const Flow::Field& f) {
  return std::sqrt(f.square().mean());
}

// Cell by cell, to rounding, whatever the flow does meanwhile.
TEST(Flow, CellsObeyTheBondsPropagator) {
  for (const auto& [ah, bh] : {std::pair(0.3, std::sqrt(2.5)), {0.1, 0.5}, {1.0, std::sqrt(2.0)}}) {
    Flow flow({.cells = 12, .viscosity = 0.05, .h = 0.02, .ah = ah, .bh = bh}, 0.1);
    const Flow::Field at_start = -0.02 * flow.divergence();  // σ₋ of a step that came with this divergence
    const double scale = at_start.abs().maxCoeff();
    const Propagator propagator(ah, bh, Damping::kDiscrete);
    for (int n = 1; n < 40; ++n) {
      flow.step();
      for (int cell = 0; cell < 144; ++cell)
        ASSERT_NEAR(flow.taken_in()(cell), propagator.residual(at_start(cell), 0, n + 1), 1e-10 * scale) << n;
    }
  }
}

// A divergence put in stays under the bare form, to rounding.
TEST(Flow, ABarePressureKeepsWhatIsPutIn) {
  Flow flow({.cells = 16, .keeps = Flow::Keeps::kBare}, 0.1);
  const Flow::Field put_in = flow.divergence();
  for (int n = 0; n < 50; ++n) flow.step();
  EXPECT_LT((flow.divergence() - put_in).abs().maxCoeff(), 1e-10);
}

// Second order in Δx, and exact but for that: e^(−2νt), whoever keeps D u = 0.
TEST(Flow, TheVortexDecaysAsTaylorAndGreenFound) {
  const auto error = [](int cells, Flow::Keeps keeps) {
    Flow flow({.cells = cells, .viscosity = 0.1, .h = 0.01, .keeps = keeps, .tolerance = 1e-10});
    for (int n = 0; n < 100; ++n) flow.step();
    return flow.error();
  };
  for (const auto keeps : {Flow::Keeps::kBare, Flow::Keeps::kProjects, Flow::Keeps::kFeedsBack}) {
    const double coarse = error(8, keeps), fine = error(16, keeps);
    EXPECT_NEAR(coarse / fine, 4, 0.3);
    EXPECT_LT(fine, 2e-3);
  }
}

// The table of systems/README.md: 400 steps, rms divergence, error of u, iterations.
TEST(Flow, CostsAndKeepsWhatTheTableSays) {
  struct Expected {
    Flow::Keeps keeps;
    double divergence, error;
    double iterations;
  };
  for (const Expected& row : {Expected{Flow::Keeps::kBare, 1.3e-3, 2.4e-3, 1616},
                              {Flow::Keeps::kFeedsBack, 1.8e-5, 2.2e-4, 3142},
                              {Flow::Keeps::kProjects, 7e-9, 2.2e-4, 7613}}) {
    Flow flow({.cells = 32, .h = 0.02, .keeps = row.keeps, .tolerance = 1e-3});
    for (int n = 0; n < 200; ++n) flow.step();
    const double halfway = rms(flow.divergence());
    for (int n = 0; n < 200; ++n) flow.step();
    EXPECT_NEAR(rms(flow.divergence()) / row.divergence, 1, 0.08);
    if (row.keeps == Flow::Keeps::kBare) {
      EXPECT_GT(rms(flow.divergence()), 1.2 * halfway) << "it grows on";
    }
    EXPECT_NEAR(flow.error() / row.error, 1, 0.03);
    EXPECT_NEAR(static_cast<double>(flow.iterations()), row.iterations, 0.01 * row.iterations);
  }
}

}  // namespace
}  // namespace taut::flow_tests
