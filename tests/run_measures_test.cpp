// What is measured of a run's log and of its chains, against closed forms.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/errors.hpp"
#include "base/random.hpp"
#include "base/series.hpp"
#include "files/h5md_file.hpp"
#include "files/h5md_reader.hpp"
#include "md/units.hpp"
#include "measures/chain_measures.hpp"
#include "measures/run_log.hpp"
#include "measures/transport.hpp"
#include "systems/scene/scene_file.hpp"
#include "temporary_folder.hpp"

namespace taut::run_measures_tests {
namespace {

using ::testing::HasSubstr;

// An AR(1) process, y₊ = ρy + √(1 − ρ²)ξ: mean 0, variance 1, correlation ρᵏ.
struct Autoregressive {
  double rho, y;
  Random random;

  Autoregressive(double decay, std::uint64_t seed) : rho(std::exp(-1 / decay)), y(0), random(seed) {
    y = random.normal_vector().x();
  }
  double next() {
    const double now = y;
    y = rho * y + std::sqrt(1 - rho * rho) * random.normal_vector().x();
    return now;
  }
  std::vector<double> series(std::size_t n) {
    std::vector<double> all(n);
    for (double& value : all) value = next();
    return all;
  }
};

// The variance of the mean of n samples, n⁻² Σᵢⱼ ρ^|i−j|.
double variance_of_mean(double rho, int n) {
  double sum = n;
  for (int k = 1; k < n; ++k) sum += 2 * (n - k) * std::pow(rho, k);
  return sum / n / n;
}

// The error holds over seeds: means of many series spread by what each says of itself, though a series is only 40
// times as long as its memory.
TEST(RunMeasures, ErrorsOfCorrelatedSeriesHoldOverSeeds) {
  constexpr int kSeries = 300, kLength = 800;
  for (const double decay : {2.0, 20.0}) {
    double said = 0, seen = 0;
    for (int seed = 1; seed <= kSeries; ++seed) {
      const Estimate mean = correlated_mean(Autoregressive(decay, seed).series(kLength));
      said += mean.error * mean.error / kSeries;
      seen += mean.value * mean.value / kSeries;
    }
    const double exact = variance_of_mean(std::exp(-1 / decay), kLength);
    EXPECT_NEAR(seen / exact, 1, 0.35) << decay;
    EXPECT_NEAR(std::sqrt(said / exact), 1, 0.12) << decay;
  }
}

TEST(RunMeasures, NumbersThatAreAlikeHaveNoError) {
  EXPECT_EQ(statistical_inefficiency(std::vector<double>(50, 7.25)), 1);
  EXPECT_EQ(correlated_mean(std::vector<double>(50, 7.25)).error, 0);
  EXPECT_EQ(correlated_mean({}).value, 0);
}

// A start far off that decays: the rule finds where it is lost in the noise, and leaves a stationary series whole.
TEST(RunMeasures, EquilibrationEndsWhereTheStartIsForgotten) {
  std::vector<double> y = Autoregressive(3, 11).series(5000), still = y;
  for (std::size_t k = 0; k < y.size(); ++k) y[k] += 20 * std::exp(-static_cast<double>(k) / 200);
  const std::size_t end = equilibration_end(y);
  EXPECT_GT(end, 400u);   // there the start is still 2.7 standard deviations off
  EXPECT_LT(end, 1600u);  // and there 0.007
  EXPECT_LT(equilibration_end(still), 500u);
}

// An Ornstein–Uhlenbeck stress of variance s² and memory τ has the viscosity η = V s²τ/kT. Each of the five
// shear stresses has that variance if xx, yy and zz have 2s² and are independent.
constexpr double kInterval = 0.002;  // [ps]

StressSeries ornstein_uhlenbeck(double decay, std::size_t rows, double bar) {
  StressSeries stress{.pressure = {}, .t = {}, .volume = 27, .temperature = 300};
  for (std::size_t row = 0; row < rows; ++row) stress.t.push_back(kInterval * static_cast<double>(row));
  for (std::size_t k = 0; k < 6; ++k) {
    stress.pressure[k] = Autoregressive(decay, 20 + k).series(rows);
    for (double& p : stress.pressure[k]) p *= bar * (k < 3 ? std::sqrt(2.0) : 1);
  }
  return stress;
}

TEST(RunMeasures, ViscosityIsRefusedWhereTheLogCannotTell) {
  EXPECT_THAT(green_kubo(ornstein_uhlenbeck(8, 900, 1)).flaw, HasSubstr("900 rows are too few"));
  EXPECT_THAT(green_kubo(ornstein_uhlenbeck(0.5, 3000, 1)).flaw, HasSubstr("too far apart"));
  EXPECT_THAT(green_kubo(ornstein_uhlenbeck(2000, 3000, 1)).flaw, HasSubstr("longer run"));
}

// The formula worked by hand for TIP3P, η = 0.31 mPa s, in a box of 2.5 nm at 298 K:
// 2.837297 · 1.380649e-23 · 298 / (6π · 0.31e-3 · 2.5e-9) = 7.9910e-10 m²/s.
TEST(RunMeasures, DiffusionInASmallBoxIsCorrected) {
  EXPECT_NEAR(finite_size_correction(298, 0.31, 2.5), 7.9910e-4, 1e-8);
}

// Ideal chains of N bonds b: ⟨R²⟩ = N b², ⟨R_g²⟩ = b² N(N + 2)/(6(N + 1)).
TEST(RunMeasures, IdealChainsAreAsLargeAsTheyShouldBe) {
  const Scene scene = read_scene(find_scene("freely_jointed"), {"build.chains=3000", "build.bond_nm=0.5"});
  ChainMeasures chains(unbranched_chains(scene.system, scene.terms));
  chains.add_frame(0, scene.start.x);
  const Estimate found = chains.gyration_squared();
  const double n = 19, exact = 0.25 * n * (n + 2) / (6 * (n + 1));
  EXPECT_NEAR(found.value, exact, 4 * found.error);
  EXPECT_NEAR(found.value, exact, 0.03 * exact);
  EXPECT_FALSE(chains.pulled());
}

// Ideal chains under a force f that acts on their ends: ⟨R·F⟩/F = N b (coth x − 1/x), x = fb/kT. Bond directions
// are drawn from their law, p(cos θ) ∝ exp(x cos θ).
TEST(RunMeasures, PulledIdealChainsFollowLangevin) {
  constexpr int kChains = 300, kBonds = 10;
  const double x = 2, b = 0.3;
  System sys;
  sys.mass = Eigen::VectorXd::Ones(kChains * (kBonds + 1));
  Terms terms;
  Vectors at = Vectors::Zero(3, sys.mass.size());
  Random random(4);
  const Vec3 force(0, 3, -4);
  const Vec3 along = force.normalized(), across = along.unitOrthogonal();
  for (int c = 0; c < kChains; ++c) {
    const int first = c * (kBonds + 1);
    for (int k = 0; k < kBonds; ++k) {
      const double u = random.uniform(), phi = 6.283185307179586 * random.uniform();
      const double cosine = std::log(std::exp(-x) + u * (std::exp(x) - std::exp(-x))) / x;
      const double sine = std::sqrt(1 - cosine * cosine);
      const Vec3 bond =
          cosine * along + sine * (std::cos(phi) * across + std::sin(phi) * along.cross(across));
      at.col(first + k + 1) = at.col(first + k) + b * bond;
      sys.bonds.push_back({first + k, first + k + 1, b});
    }
    terms.pulls.push_back({first, -force});
    terms.pulls.push_back({first + kBonds, force});
  }
  ChainMeasures chains(unbranched_chains(sys, terms));
  chains.add_frame(0, at);
  ASSERT_TRUE(chains.pulled());
  EXPECT_DOUBLE_EQ(chains.force(), 5);
  const double exact = kBonds * b * (1 / std::tanh(x) - 1 / x);
  EXPECT_NEAR(chains.extension().value, exact, 4 * chains.extension().error);
  EXPECT_NEAR(chains.extension().value, exact, 0.04 * exact);
}

TEST(RunMeasures, EndsThatHaveNotTurnedHaveNoTime) {
  ChainMeasures chains({{.atoms = {0, 1}, .first = 0, .last = 1}});
  Vectors x = Vectors::Zero(3, 2);
  x(0, 1) = 1;
  for (int frame = 0; frame < 39; ++frame) chains.add_frame(frame, x);
  EXPECT_THAT(chains.relaxation().flaw, HasSubstr("39 frames are too few"));
  chains.add_frame(39, x);
  EXPECT_THAT(chains.relaxation().flaw, HasSubstr("C = 1.00"));
}

TEST(RunMeasures, LogsAreReadAndJoined) {
  const TemporaryFolder folder;
  folder.write("log.csv", "#\"Step\",\"Time (ps)\",\"Heat (kJ/mole)\"\n0,0,\n1,0.5,2e1\n2,1,3\n3,1.5");
  RunLog log = read_log(folder.path());
  EXPECT_EQ(log.titles, (std::vector<std::string>{"Step", "Time (ps)", "Heat (kJ/mole)"}));
  EXPECT_EQ(log.rows(), 3u) << "the last line is cut off";
  EXPECT_TRUE(std::isnan(log.column("heat_kj_mol")[0]));
  EXPECT_EQ(log.column("heat_kj_mol")[1], 20);
  EXPECT_FALSE(log.has("volume_nm3"));
  log.append(read_log(folder.path()));  // a segment that counts its time from 0 again
  EXPECT_EQ(log.column("time_ps"), (std::vector<double>{0, 0.5, 1, 1.5, 2}));
  EXPECT_EQ(log.column("heat_kj_mol").back(), 3);
  folder.write("log.csv", "#\"Step\",\"Time (ps)\"\n0,x\n");
  EXPECT_THROW(read_log(folder.path()), InputError);
  folder.write("log.csv", "#\"Step\",\"Time (ps)\"\n0,1,2\n");
  EXPECT_THROW(read_log(folder.path()), InputError);
}

TEST(RunMeasures, H5mdIsReadAsItWasWritten) {
  if (!built_with_hdf5()) GTEST_SKIP() << "built without HDF5";
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "frames.h5md";
  Scene scene = read_scene(find_scene("pair"));
  State state = scene.start;
  state.f = Vectors::Zero(3, state.x.cols());
  state.box = {Vec3(4, 5, 6), Vec3(1, -1.5, 0.5)};
  const Eigen::VectorXd tension = Eigen::VectorXd::Zero(scene.system.bond_count());
  {
    H5mdFile out(file, {.sys = scene.system, .names = scene.names, .h = 0.1, .every = 5, .periodic = true},
                 0);
    for (int frame = 0; frame < 3; ++frame) {
      state.t = 2 + 0.5 * frame;
      state.x.array() += frame;
      out.add({5 * frame, state, tension});
    }
  }
  H5mdReader in(file);
  EXPECT_EQ(in.atoms(), scene.system.atoms());
  for (int frame = 0; frame < 3; ++frame) EXPECT_EQ(in.time_of(frame), 2 + 0.5 * frame);
  Vectors x;
  Box box;
  int frames = 0;
  while (in.next(x, box)) ++frames;
  EXPECT_EQ(frames, 3);
  EXPECT_EQ(x, state.x);
  EXPECT_EQ(box.edge, state.box.edge);
  EXPECT_EQ(box.tilt, state.box.tilt);
  EXPECT_THROW(H5mdReader(folder.write("none.h5md", "nothing")), InputError);
  EXPECT_THROW(H5mdReader(folder.path() / "absent.h5md"), InputError);
}

}  // namespace
}  // namespace taut::run_measures_tests
