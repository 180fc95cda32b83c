// Rows and frames that are unevenly spaced in time: a run that was resumed with another run.log_every, joined segments.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "base/even_times.hpp"
#include "base/random.hpp"
#include "base/series.hpp"
#include "measures/chain_measures.hpp"
#include "measures/measures.hpp"
#include "measures/transport.hpp"
#include "simulation/simulation.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut::uneven_rows_tests {
namespace {

// So many samples from `t` on, `interval` apart.
void add_times(std::vector<double>& t, double begin, double interval, int samples) {
  for (int k = 0; k < samples; ++k) t.push_back(begin + k * interval);
}

// An AR(1) process of correlation e^(−k/decay).
std::vector<double> autoregressive(double decay, std::size_t samples, std::uint64_t seed) {
  Random random(seed);
  const double rho = std::exp(-1 / decay);
  std::vector<double> all;
  double y = random.normal();
  for (std::size_t k = 0; k < samples; ++k) {
    all.push_back(y);
    y = rho * y + std::sqrt(1 - rho * rho) * random.normal();
  }
  return all;
}

TEST(EvenParts, AreStretchesOrEverySoManieth) {
  std::vector<double> t;
  add_times(t, 5, 0.1, 100);
  EXPECT_TRUE(even_parts(t).front().whole(t));
  EXPECT_NEAR(even_parts(t).front().interval, 0.1, 1e-12);
  std::vector<double> ended = t;
  ended.push_back(14.95);  // a row of the end's own
  ASSERT_EQ(even_parts(ended).size(), 1u);
  EXPECT_EQ(even_parts(ended).front().samples.size(), 100u);

  std::vector<double> resumed;  // 4 and 8, as long in time: every second of the first half
  add_times(resumed, 0, 4, 100);
  add_times(resumed, 400, 8, 50);
  EXPECT_EQ(even_parts(resumed).front().samples.size(), 100u);
  EXPECT_NEAR(even_parts(resumed).front().interval, 8, 1e-9);
  for (std::size_t k = 0; k < 100; ++k)
    EXPECT_NEAR(resumed[even_parts(resumed)[0].samples[k]], 8 * static_cast<double>(k), 1e-9);

  std::vector<double> coprime;  // 4 and 6: 12
  add_times(coprime, 0, 4, 300);
  add_times(coprime, 1200, 6, 200);
  EXPECT_NEAR(even_parts(coprime).front().interval, 12, 1e-9);
  EXPECT_EQ(even_parts(coprime).front().samples.size(), 200u);
  EXPECT_NEAR(even_parts(coprime).back().interval, 4, 1e-9);
  EXPECT_EQ(even_parts(coprime).back().samples.size(), 301u);

  std::vector<double> apart;  // a piece is missing between
  add_times(apart, 0, 1, 60);
  add_times(apart, 500.3, 1, 80);
  EXPECT_EQ(even_parts(apart).back().samples.front(), 60u);
  EXPECT_EQ(even_parts(apart).back().samples.size(), 80u);
  EXPECT_TRUE(even_parts({}).front().samples.empty());
}

// y = 1 for 40 ps in rows 1 ps apart, y = 3 for 120 ps in rows 10 ps apart: ⟨y⟩ = 2.5, by rows 1.46.
TEST(EvenMeans, WeighTimeNotRows) {
  std::vector<double> t, y(40, 1.0);
  add_times(t, 1, 1, 40);
  add_times(t, 50, 10, 12);
  y.resize(t.size(), 3.0);
  const std::vector<double> even = EvenMeans(t).of(y);
  EXPECT_EQ(even.size(), 16u) << "of 10 ps";
  EXPECT_NEAR(independent_mean(even).value, 2.5, 0.02);
  std::vector<double> turned_t, turned_y(12, 3.0);  // and where the rows become denser
  add_times(turned_t, 10, 10, 12);
  add_times(turned_t, 121, 1, 40);
  turned_y.resize(52, 1.0);
  EXPECT_NEAR(independent_mean(EvenMeans(turned_t).of(turned_y)).value, 2.5, 1e-12);
  EXPECT_EQ(EvenMeans(turned_t).first_sample(12), 12u);
  std::vector<double> still;
  add_times(still, 0, 0.002, 52);
  EXPECT_EQ(EvenMeans(still).of(turned_y), turned_y);
  std::vector<double> apart = {0, 1, 2, 3, 100, 101, 102, 103};  // nothing is known of what is between
  EXPECT_EQ(EvenMeans(apart).of(std::vector<double>{1, 1, 1, 1, 5, 5, 5, 5}),
            (std::vector<double>{1, 1, 1, 1, 5, 5, 5, 5}));
}

// A stress of memory 8 rows whose second half has every second row alone: the viscosity is that of the whole series,
// with no factor of the spacing.
TEST(UnevenRows, HaveTheViscosityOfEvenOnes) {
  constexpr std::size_t kRows = 40000;
  constexpr double bar = 900, decay = 8;
  StressSeries all{.pressure = {}, .t = {}, .volume = 27, .temperature = 300}, thinned = all;
  for (std::size_t k = 0; k < 6; ++k) {
    all.pressure[k] = autoregressive(decay, kRows, 20 + k);
    for (double& p : all.pressure[k]) p *= bar * (k < 3 ? std::sqrt(2.0) : 1);
  }
  for (std::size_t row = 0; row < kRows; ++row) {
    all.t.push_back(0.002 * static_cast<double>(row));
    if (row >= kRows / 4 && row % 2 == 1) continue;
    thinned.t.push_back(all.t.back());
    for (std::size_t k = 0; k < 6; ++k) thinned.pressure[k].push_back(all.pressure[k][row]);
  }
  const GreenKubo whole = green_kubo(all), part = green_kubo(thinned);
  ASSERT_EQ(whole.flaw + part.flaw, "");
  const double exact = 27e-27 / (1.380649e-23 * 300) * bar * 1e5 * bar * 1e5 * decay * 0.002e-12 * 1e3;
  EXPECT_NEAR(part.rows.interval, 0.004, 1e-9);
  EXPECT_EQ(part.rows.samples.size(), kRows / 2);
  EXPECT_NEAR(part.viscosity.value, exact, 0.12 * exact);
  EXPECT_NEAR(whole.viscosity.value, exact, 0.12 * exact);
  EXPECT_LT(whole.viscosity.error, 0.15 * exact);
  EXPECT_GT(whole.cut, 3 * decay * 0.002);
  // Where the second half is too coarse to tell, the first half does.
  StressSeries coarse{.pressure = {}, .t = {}, .volume = 27, .temperature = 300};
  for (std::size_t row = 0; row < kRows; row += row < kRows / 4 ? 1 : 10) {
    coarse.t.push_back(all.t[row]);
    for (std::size_t k = 0; k < 6; ++k) coarse.pressure[k].push_back(all.pressure[k][row]);
  }
  const GreenKubo fine = green_kubo(coarse);
  ASSERT_EQ(fine.flaw, "");
  EXPECT_NEAR(fine.rows.interval, 0.002, 1e-9);
  EXPECT_NEAR(fine.viscosity.value, exact, 4 * fine.viscosity.error);
}

// Random walks of D = 0.5 nm²/ps, 300 frames a ps apart and 300 more 4 ps apart.
TEST(UnevenRows, DiffuseAsFarAsTheirTimesSay) {
  std::vector<double> t;
  add_times(t, 0, 1, 300);
  add_times(t, 303, 4, 300);
  constexpr int kWalkers = 300;
  Random random(5);
  Vectors x = Vectors::Zero(3, kWalkers);
  std::vector<int> each(kWalkers);
  std::iota(each.begin(), each.end(), 0);
  MeanSquareDisplacement motion(Eigen::VectorXd::Ones(kWalkers), each);
  for (std::size_t frame = 0; frame < t.size(); ++frame) {
    motion.see(t[frame], x);
    if (frame + 1 < t.size())
      for (int w = 0; w < kWalkers; ++w)
        x.col(w) += std::sqrt(t[frame + 1] - t[frame]) * random.normal_vector();
  }
  const auto moved = motion.result();
  EXPECT_NEAR(moved.frames.interval, 4, 1e-9);
  EXPECT_NEAR(moved.diffusion.value, 0.5, 4 * moved.diffusion.error);
  EXPECT_NEAR(moved.diffusion.value, 0.5, 0.05);
}

// Dumbbells that forget their direction within 12 ps, in frames 1 ps and then 2 ps apart, which are half as many.
TEST(UnevenRows, HaveTheRelaxationOfTheirTimes) {
  constexpr int kChains = 60, kSteps = 1200;
  std::vector<Chain> all;
  std::vector<std::vector<double>> walks;
  for (int c = 0; c < kChains; ++c) {
    all.push_back({.atoms = {2 * c, 2 * c + 1}, .first = 2 * c, .last = 2 * c + 1});
    for (int d = 0; d < 3; ++d) walks.push_back(autoregressive(12, kSteps, 100 + 3 * c + d));
  }
  ChainMeasures chains(all);
  for (int step = 0; step < kSteps; step += step < kSteps / 3 ? 1 : 2) {
    Vectors x = Vectors::Zero(3, 2 * kChains);
    for (int c = 0; c < kChains; ++c)
      for (int d = 0; d < 3; ++d)
        x(d, 2 * c + 1) = walks[static_cast<std::size_t>(3 * c + d)][static_cast<std::size_t>(step)];
    chains.add_frame(step, x);
  }
  const auto relaxation = chains.relaxation();
  ASSERT_EQ(relaxation.flaw, "");
  EXPECT_NEAR(relaxation.time.value, 12, 4 * relaxation.time.error);
  EXPECT_NEAR(relaxation.time.value, 12, 1.5);
  for (std::size_t k = 0; k < relaxation.t.size(); k += 20)
    EXPECT_NEAR(relaxation.correlation[k].value, std::exp(-relaxation.t[k] / 12), 0.06);
  EXPECT_NEAR(chains.gyration_squared().value, 0.75, 4 * chains.gyration_squared().error);
}

// Pairs at 0.35 nm for 10 frames 1 ps apart, at 0.75 nm for 10 frames 9 ps apart: a tenth and nine tenths of the time.
TEST(UnevenRows, HaveTheStructureOfTheirTime) {
  const Box box{Vec3(4, 4, 4)};
  RadialDistribution pairs({0}, {1}, {0, 1}, 1);
  EndToEnd ends({{0, 1}});
  std::vector<double> t;
  add_times(t, 1, 1, 10);
  add_times(t, 19, 9, 10);
  for (std::size_t frame = 0; frame < t.size(); ++frame) {
    Vectors x = Vectors::Zero(3, 2);
    x(0, 1) = frame < 10 ? 0.355 : 0.755;
    pairs.see(t[frame], x, box);
    ends.see(t[frame], x);
  }
  const Distances g = pairs.result();
  const auto pairs_at = [&](std::size_t bin) {
    return g.g[bin].value * (std::pow(bin + 1, 3) - std::pow(bin, 3));
  };
  EXPECT_NEAR(pairs_at(75) / pairs_at(35), 9, 1.2);
  EXPECT_NEAR(ends.squared().value, 0.1 * 0.355 * 0.355 + 0.9 * 0.755 * 0.755, 0.02);
}

// The sum over lags, term by term.
TEST(UnevenRows, TheInefficiencyIsTheSumOverLags) {
  std::vector<double> trend;
  for (int k = 0; k < 3000; ++k) trend.push_back(1e3 + 0.01 * k);
  for (const std::vector<double>& y : {trend, autoregressive(10, 3000, 3)}) {
    const double n = static_cast<double>(y.size()), mean = std::accumulate(y.begin(), y.end(), 0.0) / n;
    const auto product = [&](std::size_t lag) {
      double sum = 0;
      for (std::size_t i = 0; i + lag < y.size(); ++i) sum += (y[i] - mean) * (y[i + lag] - mean);
      return sum;
    };
    double g = 1;
    for (std::size_t k = 1; k + 1 < y.size(); ++k) {
      const double share = static_cast<double>(k) / n, c = product(k) / (1 - share) / product(0);
      if (c <= 0) break;
      g += 2 * c * (1 - share);
    }
    EXPECT_NEAR(statistical_inefficiency(y) / g, 1, 1e-9);
  }
}

// A run's own means after its rows became ten times as far apart: those of its rows in time.
TEST(UnevenRows, OfARunHaveMeansInTime) {
  const Scene scene = read_scene(find_scene("freely_jointed"),
                                 {"build.chains=3", "run.thermostat=langevin", "run.temperature_k=300",
                                  "run.friction_per_ps=2", "run.steps=400", "run.log_every=1"});
  Simulation simulation(scene);
  RunSettings run = scene.run;
  run.steps = 2400;
  double sum = 0, drift_rows = 0, squares = 0;
  long last = 0, all = 0;
  const auto on_record = [&](const Record& r) {
    const long since = r.step > last ? r.step - last : 1;
    sum += static_cast<double>(since) * r.temperature;
    squares += static_cast<double>(since) * r.bonds.rms * r.bonds.rms;
    all += since, last = r.step, ++drift_rows;
  };
  simulation.run(on_record);
  run.log_every = 40;
  simulation.change(run);
  const Summary summary = simulation.run(on_record);
  EXPECT_EQ(drift_rows, 401 + 50);
  EXPECT_EQ(all, 2401);
  EXPECT_NEAR(summary.temperature, sum / static_cast<double>(all), 1e-9);
  EXPECT_NEAR(summary.rms_rel_bond_error, std::sqrt(squares / static_cast<double>(all)), 1e-15);
}

// Numbers that stand for more steps weigh more, in the mean and in its blocks.
TEST(RunningMean, WeighsStepsNotNumbers) {
  RunningMean mean;
  for (int n = 0; n < 64; ++n) mean.add(1, 2);
  for (int n = 0; n < 4; ++n) mean.add(5, 96);
  EXPECT_DOUBLE_EQ(mean.estimate().value, (128 * 1 + 384 * 5) / 512.0);
  const double of_blocks = independent_mean(mean.blocks()).value;
  EXPECT_NEAR(of_blocks, 4, 0.15);
  RunningSlope slope;
  for (int n = 0; n < 50; ++n) slope.add(n, 2.0 * n);
  for (int n = 1; n < 50; ++n) slope.add(49 + 10 * n, 2.0 * (49 + 10 * n), 10);
  EXPECT_NEAR(slope.estimate().value, 2, 1e-12);
}

}  // namespace
}  // namespace taut::uneven_rows_tests
