// Averages with error bars, and what a liquid looks like, on data whose answer is known.

#include "base/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.hpp"
#include "base/zero_step.hpp"
#include "measures/liquid_structure.hpp"
#include "studies/crosscheck_verdict.hpp"

namespace taut::statistics_tests {
namespace {

// Points on y = 7 − 0.5h² of their own errors: the line's value, and the error that weights give by hand,
// σ² = Σwh⁴/(Σw Σwh⁴ − (Σwh²)²).
TEST(ZeroStep, IsTheWeightedLinesValue) {
  const std::vector<AtStep> points = {{2, {5, 0.1}}, {4, {-1, 0.2}}, {5, {-5.5, 0.5}}};
  const auto found = at_zero_step(points);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->value.value, 7, 1e-12);
  EXPECT_NEAR(found->slope.value, -0.5, 1e-12);
  double w = 0, wx = 0, wxx = 0;
  for (const auto& [h, mean] : points) {
    const double weight = 1 / (mean.error * mean.error);
    w += weight, wx += weight * h * h, wxx += weight * h * h * h * h;
  }
  EXPECT_NEAR(found->value.error, std::sqrt(wxx / (w * wxx - wx * wx)), 1e-12);
  EXPECT_NEAR(found->slope.error, std::sqrt(w / (w * wxx - wx * wx)), 1e-12);
  EXPECT_NEAR(found->chi_square, 0, 1e-20);
  EXPECT_TRUE(found->on_the_line());
}

// Over many draws about a line the value scatters as its error says, and one in a hundred is told off the line. With a
// part in h⁴ of a few errors the points are.
TEST(ZeroStep, TellsWhetherPointsLieOnTheLine) {
  Random random(5);
  int off = 0;
  double squares = 0;
  constexpr int kDraws = 4000;
  for (int n = 0; n < kDraws; ++n) {
    std::vector<AtStep> points;
    for (const double h : {1.0, 2.0, 4.0, 5.0, 6.0})
      points.push_back({h, {3 + 0.2 * h * h + 0.4 * random.normal(), 0.4}});
    const auto found = at_zero_step(points);
    off += !found->on_the_line();
    squares += std::pow((found->value.value - 3) / found->value.error, 2) / kDraws;
  }
  EXPECT_NEAR(squares, 1, 0.1);
  EXPECT_NEAR(off, kDraws / 100, 25);
  const std::vector<AtStep> curved = {{2, {0.16, 0.1}}, {4, {2.56, 0.1}}, {6, {12.96, 0.1}}};
  EXPECT_FALSE(at_zero_step(curved)->on_the_line());
}

TEST(ZeroStep, NeedsTwoStepsAndErrors) {
  EXPECT_FALSE(at_zero_step({}));
  EXPECT_FALSE(at_zero_step(std::vector<AtStep>{{2, {1, 1}}, {2, {1, 1}}}));
  EXPECT_FALSE(at_zero_step(std::vector<AtStep>{{2, {1, 1}}, {4, {1, 0}}}));
  const auto two = at_zero_step(std::vector<AtStep>{{2, {1, 1}}, {4, {2, 1}}});
  ASSERT_TRUE(two);
  EXPECT_EQ(two->free, 0);
  EXPECT_EQ(two->chance, 1);
}

// y_{n+1} = c y_n + √(1−c²) R has variance 1 and its mean an error of √((1+c)/(1−c)/n).
TEST(BlockAverage, OfCorrelatedNumbersKnowsThatTheyAre) {
  Random random(2);
  const double c = 0.9;
  std::vector<double> y;
  double now = 0;
  for (int n = 0; n < 100000; ++n) y.push_back(now = c * now + std::sqrt(1 - c * c) * random.normal());
  const double expected = std::sqrt((1 + c) / (1 - c) / 100000);
  EXPECT_NEAR(block_mean(y, 100).error, expected, 0.25 * expected);
}

// 7 numbers in 3 blocks of 2: the first is left out.
TEST(BlockAverage, LeavesOutTheStart) {
  const Estimate mean = block_mean({1000, 1, 3, 4, 6, 8, 8}, 3);
  EXPECT_NEAR(mean.value, 5, 1e-14);
  EXPECT_NEAR(mean.error, std::sqrt((9 + 0 + 9) / 6.0), 1e-14);
}

TEST(BlockAverage, SlopeOfALine) {
  std::vector<double> t, y;
  for (int n = 0; n < 100; ++n) t.push_back(0.1 * n), y.push_back(5 - 2 * t.back());
  EXPECT_NEAR(block_slope(t, y).value, -2, 1e-12);
  EXPECT_NEAR(block_slope(t, y).error, 0, 1e-12);
}

TEST(BlockAverage, DeviationsAreInCommonErrors) {
  EXPECT_DOUBLE_EQ(deviations({1, 3}, {11, 4}), 2);
  EXPECT_DOUBLE_EQ(deviations({1, 0}, {11, 0}), 0);
  for (const Estimate& none : {Estimate{NAN, 0}, Estimate{NAN, 1}, Estimate{1, NAN}}) {
    EXPECT_TRUE(std::isnan(deviations({1, 0}, none)));
    EXPECT_TRUE(std::isnan(deviations(none, {1, 1})));
  }
}

constexpr double kEdge = 2;  // [nm]

const Box kBox{{kEdge, kEdge, kEdge}};

// Rigid waters with their oxygens anywhere: an ideal gas.
System waters(int count) {
  Eigen::VectorXd mass(3 * count);
  std::vector<RigidBond> bonds;
  for (int w = 0; w < count; ++w) {
    mass.segment<3>(3 * w) << 15.999, 1.008, 1.008;
    bonds.push_back({3 * w, 3 * w + 1, 0.1});
    bonds.push_back({3 * w, 3 * w + 2, 0.1});
    bonds.push_back({3 * w + 1, 3 * w + 2, 0.16});
  }
  return make_system(mass, bonds);
}

// Two oxygens, one frame, seen across the box: one pair in one bin.
TEST(LiquidStructure, CountsThePairAtItsNearestImage) {
  const System sys = waters(2);
  LiquidStructure structure(sys, {}, kBox);
  State s{Vectors::Zero(3, 6), {}, {}, 0, kBox};
  Vectors& x = s.x;
  x.col(3) << kEdge - 0.305, 0, 0;
  structure.see(s);
  const Distances g = structure.oxygen_distances();
  const double shell = 4.0 / 3 * M_PI * (std::pow(0.31, 3) - std::pow(0.30, 3));
  EXPECT_NEAR(g.g[30].value, kEdge * kEdge * kEdge / shell, 1e-9 * g.g[30].value);
  EXPECT_EQ(g.g[29].value, 0);
  EXPECT_EQ(g.g[31].value, 0);
}

TEST(LiquidStructure, EndsOfAChain) {
  const System sys = make_system(Eigen::VectorXd::Ones(8), {{0, 1, 1}, {1, 2, 1}, {2, 3, 1}, {4, 5, 1}});
  LiquidStructure structure(sys, {}, kBox);
  EXPECT_FALSE(structure.has_water());
  ASSERT_TRUE(structure.has_chains()) << "0-1-2-3; 4-5 is no chain";
  State s{Vectors::Zero(3, 8), {}, {}, 0, kBox};
  Vectors& x = s.x;
  x.col(3) << 2, 2, 1;
  structure.see(s);
  EXPECT_DOUBLE_EQ(structure.end_to_end().value, 3);
}

Verdict verdict_on(const Crosscheck& c, const std::string& who) {
  for (const Verdict& v : verdicts(c))
    if (v.who == who) return v;
  ADD_FAILURE() << "no verdict on " << who;
  return {};
}

Crosscheck one_run(std::vector<Sample> samples) {
  Crosscheck c;
  c.bonds = 1;
  c.steps = c.parting = 100;
  c.agreement = 1e-6;
  c.platform = "Reference";
  c.start.energy = c.start.openmm_energy = c.start.force_rms = 1;
  c.tracks.emplace_back();
  c.tracks[0].name = "newton";
  c.tracks[0].samples = std::move(samples);
  return c;
}

TEST(Verdict, OfTheStart) {
  Crosscheck c = one_run({});
  EXPECT_EQ(verdict_on(c, "start").finding, Finding::kAgrees);
  c.start.openmm_energy = -1;
  EXPECT_EQ(verdict_on(c, "start").finding, Finding::kDiffers);
  c.start.openmm_energy = 1;
  c.start.force_difference = 2;
  EXPECT_EQ(verdict_on(c, "start").finding, Finding::kDiffers);
}

TEST(Verdict, OfARun) {
  const Sample start{}, near{.step = 50, .apart = 9e-7}, far{.step = 100, .apart = 2e-6};
  EXPECT_EQ(verdict_on(one_run({start, near}), "newton").finding, Finding::kAgrees);
  const Verdict parted = verdict_on(one_run({start, near, far}), "newton");
  EXPECT_EQ(parted.finding, Finding::kParts);
  EXPECT_NE(parted.why.find("at step 100"), std::string::npos) << parted.why;
  Crosscheck c = one_run({start});
  c.tracks[0].failure = "step 7: a bond broke";
  EXPECT_EQ(verdict_on(c, "newton").finding, Finding::kFailed);
}

// OpenMM's rounded lengths are to blame only where its forces are as exact as ours.
TEST(Verdict, BlamesRoundedLengthsOnlyInDoublePrecision) {
  Crosscheck c = one_run({Sample{}, Sample{.step = 100, .apart = 2e-6}});
  c.openmm_bonds = {
      .worst = 3e-8, .rounded = 1, .steps = 100, .apart_as_given = 2e-6, .apart_with_theirs = 1e-12};
  EXPECT_NE(verdict_on(c, "newton").why.find("rounded to float"), std::string::npos);
  c.platform = "CPU";
  c.in_double = false;
  EXPECT_EQ(verdict_on(c, "newton").why.find("rounded to float"), std::string::npos);
}

TEST(Verdict, OfAverages) {
  Crosscheck c = one_run({Sample{}});
  c.long_enough = true;
  c.twin.temperature = {300, 1};
  c.tracks[0].temperature = {302, 1};
  EXPECT_EQ(verdict_on(c, "newton, averages").finding, Finding::kAgrees);
  for (const double off : {310.0, std::nan("")}) {
    c.tracks[0].temperature = {off, 1};
    EXPECT_EQ(verdict_on(c, "newton, averages").finding, Finding::kDiffers);
  }
}

TEST(Verdict, OfEnergyDrift) {
  Crosscheck c = one_run({Sample{}});
  c.long_enough = true;
  c.twin.drift = {0.1, 0.03};
  c.tracks[0].drift = {0.15, 0.04};
  EXPECT_EQ(verdict_on(c, "newton, energy").finding, Finding::kAgrees);
  c.tracks[0].drift = {-0.4, 0.04};
  EXPECT_EQ(verdict_on(c, "newton, energy").finding, Finding::kDiffers);
  EXPECT_NE(verdict_on(c, "newton, energy").why.find("worse"), std::string::npos);
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

}  // namespace
}  // namespace taut::statistics_tests
