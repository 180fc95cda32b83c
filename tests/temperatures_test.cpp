// Temperatures of translation, rotation and the rest, a molecule type at a time.

#include "simulation/temperatures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/series.hpp"
#include "base/statistics.hpp"
#include "constraints/projection.hpp"
#include "free_system.hpp"
#include "md/observables.hpp"
#include "md/units.hpp"

namespace taut::temperatures_tests {
namespace {

// Velocities drawn at 300 K and projected: every class has its temperature, each with its own count.
TEST(Temperatures, OfProjectedVelocitiesAreThoseTheyWereDrawnAt) {
  auto [sys, s] = tests::waters(30, 1, 300);
  Projector projector(sys);
  Temperatures temperatures(sys, {}, s.x, true);
  ASSERT_EQ(temperatures.types().size(), 1u);
  EXPECT_EQ(temperatures.types()[0].name, "30 molecules of 3 atoms");
  EXPECT_EQ(temperatures.types()[0].dof, (std::array<double, 3>{90, 90, 0}));
  Random random(2);
  for (int n = 0; n < 400; ++n) {
    for (int a = 0; a < sys.atoms(); ++a)
      s.v.col(a) = std::sqrt(kBoltzmann * 300 * sys.inv_mass[a]) * random.normal_vector();
    projector.velocities(sys, s.x, s.v);
    temperatures.see(sys, s.x, s.v);
  }
  for (const MotionClass motion : {MotionClass::kTranslation, MotionClass::kRotation}) {
    const Estimate t = temperatures.temperature(0, motion);
    EXPECT_NEAR(t.value, 300, 4 * t.error);
    EXPECT_NEAR(t.error, 300 * std::sqrt(2.0 / 90 / 400), 0.8);
    EXPECT_EQ(temperatures.of_all(motion).value, t.value);
  }
  EXPECT_EQ(temperatures.temperature(0, MotionClass::kRest).value, 0);
}

// A chain of four, a rotor, a lone atom and an anchored one: the counts of each.
TEST(Temperatures, CountsEveryKindOfMolecule) {
  Eigen::VectorXd mass(9);
  mass << 1, 1, 1, 1, 2, 2, 5, 0, 1;
  const System sys = make_system(mass, {{0, 1, 1}, {1, 2, 1}, {2, 3, 1}, {4, 5, 1}, {7, 8, 1}});
  Vectors x = Vectors::Zero(3, 9);
  for (int a = 0; a < 9; ++a) x.col(a) << a, a % 2, 0.3 * (a % 3);
  const Temperatures held(sys, {}, x, true, {RigidMotions::Which::kTranslations, sys, x}),
      springs(sys, {}, x, false);
  ASSERT_EQ(held.types().size(), 4u);
  EXPECT_EQ(held.types()[2].name, "1 atom");
  const double total = 13;  // of the free molecules' masses, beside the anchored one's
  EXPECT_EQ(held.types()[0].dof[1], 3);
  EXPECT_EQ(held.types()[0].dof[2], 12 - 3 - 6);
  EXPECT_EQ(held.types()[1].dof[1], 2);
  EXPECT_EQ(held.types()[1].dof[2], 0);
  EXPECT_THAT(held.types()[3].dof, testing::ElementsAre(0, 0, testing::DoubleEq(2 - 3 / (total + 1))));
  EXPECT_DOUBLE_EQ(held.types()[2].dof[0], 3 - 3 * 5 / (total + 1));
  EXPECT_EQ(springs.types()[0].dof[2], 12 - 6);
}

// The same masses tied otherwise are another kind: a chain of three and a triangle.
TEST(Temperatures, KindsDifferByTheirBondsToo) {
  const System sys =
      make_system(Eigen::VectorXd::Ones(6), {{0, 1, 1}, {1, 2, 1}, {3, 4, 1}, {4, 5, 1}, {5, 3, 1}});
  Vectors x = Vectors::Zero(3, 6);
  for (int a = 0; a < 6; ++a) x.col(a) << a, a % 2, 0;
  const Temperatures temperatures(sys, {}, x, true);
  ASSERT_EQ(temperatures.types().size(), 2u);
  EXPECT_EQ(temperatures.types()[0].dof, (std::array<double, 3>{3, 3, 1}));
  EXPECT_EQ(temperatures.types()[1].dof, (std::array<double, 3>{3, 3, 0}));
}

// The three classes have all of the kinetic energy, and what bends alone is the rest.
TEST(Temperatures, ShareTheKineticEnergy) {
  auto [sys, s] = tests::free_chain(4, 5);
  Projector(sys).velocities(sys, s.x, s.v);
  const auto energy = [&, &sys = sys, &s = s](MotionClass motion) {
    Temperatures temperatures(sys, {}, s.x, true);
    temperatures.see(sys, s.x, s.v);
    const double dof = temperatures.types()[0].dof[static_cast<std::size_t>(motion)];
    return 0.5 * dof * kBoltzmann * temperatures.of_all(motion).value;
  };
  const double translation = 0.5 * momentum(sys, s.v).squaredNorm() / sys.mass.sum();
  EXPECT_NEAR(energy(MotionClass::kTranslation), translation, 1e-12);
  EXPECT_GT(energy(MotionClass::kRotation), 0.01);
  EXPECT_NEAR(energy(MotionClass::kTranslation) + energy(MotionClass::kRotation) + energy(MotionClass::kRest),
              kinetic_energy(sys, s.v), 1e-12);
}

// Beside plain block means: for 100 numbers of blocks of 4, 25 of them; the mean is of all numbers.
TEST(RunningMean, HasTheErrorOfItsBlocks) {
  Random random(3);
  RunningMean mean;
  std::vector<double> y;
  for (int n = 0; n < 102; ++n) mean.add(y.emplace_back(n * n % 31 + random.normal()));
  double all = 0;
  for (const double value : y) all += value / 102;
  EXPECT_NEAR(mean.estimate().value, all, 1e-12);
  y.resize(100);
  std::vector<double> blocks;
  for (std::size_t b = 0; b < 25; ++b)
    blocks.push_back((y[4 * b] + y[4 * b + 1] + y[4 * b + 2] + y[4 * b + 3]) / 4);
  EXPECT_NEAR(mean.estimate().error, mean_of_run(blocks).error, 1e-12);

  RunningMean few;
  for (int n = 0; n < 7; ++n) few.add(n);
  EXPECT_EQ(few.estimate().error, 0);
  few.add(20);
  EXPECT_NEAR(few.estimate().error, mean_of_run(std::vector<double>{0, 1, 2, 3, 4, 5, 6, 20}).error, 1e-12);
}

// The mean of AR(1) series that begin off their mean and decay to it: how far it is off, and its error, both rms over
// seeds in units of the series' own spread.
struct OverSeeds {
  double off = 0, error = 0;
  double within = 0;  // share of the seeds whose mean is off by less than two errors
};

OverSeeds mean_over_seeds(double correlation_times, double start, double decay) {
  constexpr int kSeeds = 300, kRows = 2000;
  const double c = std::exp(-correlation_times / kRows);
  OverSeeds all;
  for (int seed = 0; seed < kSeeds; ++seed) {
    Random random(static_cast<std::uint64_t>(100 + seed));
    RunningMean mean;
    double y = random.normal();
    for (int n = 0; n < kRows; ++n) {
      mean.add(y + start * std::exp(-n / (decay * kRows)));
      y = c * y + std::sqrt(1 - c * c) * random.normal();
    }
    const auto [value, error] = mean.estimate();
    all.off += value * value / kSeeds;
    all.error += error * error / kSeeds;
    all.within += (std::abs(value) < 2 * error) / static_cast<double>(kSeeds);
  }
  return {std::sqrt(all.off), std::sqrt(all.error), all.within};
}

// The error of a slow quantity is the spread of its means over seeds: of series fifty correlation times long, and of
// twenty. Blocks taken for independent say 0.75 and 0.5 of it.
TEST(RunningMean, ItsErrorIsTheSpreadOverSeeds) {
  for (const double times : {50.0, 20.0}) {
    const OverSeeds all = mean_over_seeds(times, 0, 1);
    EXPECT_GT(all.error / all.off, 0.95) << times;
    EXPECT_LT(all.error / all.off, 1.4) << times;
    EXPECT_GT(all.within, 0.86) << times;
  }
}

// A start three or ten spreads off, which decays in a tenth of the run or in three tenths: correlated blocks alone say
// 0.6 of what the slower leaves. What decays in the whole run is not covered.
TEST(RunningMean, ItsErrorCoversASlowStart) {
  for (const double start : {3.0, 10.0})
    for (const double decay : {0.1, 0.3}) {
      const OverSeeds all = mean_over_seeds(50, start, decay);
      EXPECT_GT(all.error / all.off, 1) << start << " in " << decay;
      EXPECT_LT(all.error / all.off, 1.7) << start << " in " << decay;
      EXPECT_GT(all.within, 0.75) << start << " in " << decay;
    }
  EXPECT_LT(mean_over_seeds(50, 3, 1).within, 0.6);
}

// A straight trimer turns about two axes and has two ways to bend; bent, it is three and one. Each counts in
// its own time.
TEST(Temperatures, OfAMoleculeThatBends) {
  const System sys = make_system(Eigen::VectorXd::Ones(3), {{0, 1, 1}, {1, 2, 1}});
  Vectors straight(3, 3), bent(3, 3);
  straight << -1, 0, 1, 0, 0, 0, 0, 0, 0;
  bent << -0.8, 0, 0.8, 0.6, 0, 0.6, 0, 0, 0;
  Projector projector(sys);
  for (const bool bends : {false, true}) {
    Temperatures temperatures(sys, {}, straight, true);
    EXPECT_EQ(temperatures.types()[0].dof, (std::array<double, 3>{3, 2, 2}));
    Random random(3);
    const int samples = 20000;
    for (int n = 0; n < samples; ++n) {
      const Vectors& x = bends && n >= samples / 4 ? bent : straight;
      Vectors v(3, 3);
      for (int a = 0; a < 3; ++a) v.col(a) = std::sqrt(kBoltzmann * 300) * random.normal_vector();
      projector.velocities(sys, x, v);
      temperatures.see(sys, x, v);
    }
    EXPECT_NEAR(temperatures.types()[0].dof[1], bends ? 2.75 : 2, 1e-9);
    EXPECT_NEAR(temperatures.types()[0].dof[2], bends ? 1.25 : 2, 1e-9);
    for (int motion = 0; motion < 3; ++motion)
      EXPECT_NEAR(temperatures.temperature(0, MotionClass(motion)).value, 300, 12) << kMotionNames[motion];
  }
}

}  // namespace
}  // namespace taut::temperatures_tests
