// What is measured along a trajectory, against closed forms.

#include "measures/measures.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

#include "base/errors.hpp"
#include "base/random.hpp"
#include "files/dcd_file.hpp"
#include "measures/liquid_structure.hpp"
#include "systems/scene/scene_file.hpp"
#include "temporary_folder.hpp"

namespace taut::measures_tests {
namespace {

std::vector<int> numbers(int n) {
  std::vector<int> all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

// Free particles in Langevin's bath, an Ornstein–Uhlenbeck process (Uhlenbeck and Ornstein 1930,
// doi:10.1103/PhysRev.36.823), stepped by its exact law:
//     ⟨Δr²⟩ = 6kT/(mγ²) (γt − 1 + e^{−γt}),   D = kT/(mγ)
// Two atoms of a molecule ride side by side, so that the centre moves as each.
TEST(Measures, FreeParticlesDiffuseByEinsteinsLaw) {
  constexpr int kMolecules = 200, kFrames = 4000;
  constexpr double kGamma = 2, kT = 1.5, h = 0.1;
  const double c = std::exp(-kGamma * h), var_v = kT * (1 - c * c),
               var_x = kT / (kGamma * kGamma) * (2 * kGamma * h - 3 + 4 * c - c * c),
               cov = kT / kGamma * (1 - c) * (1 - c), b = cov / std::sqrt(var_v);
  Random random(5);
  Vectors x = Vectors::Zero(3, kMolecules), v(3, kMolecules);
  for (int m = 0; m < kMolecules; ++m) v.col(m) = std::sqrt(kT) * random.normal_vector();
  std::vector<int> molecule = numbers(kMolecules);
  molecule.insert(molecule.end(), molecule.begin(), molecule.end());
  Eigen::VectorXd mass(2 * kMolecules);
  mass << Eigen::VectorXd::Constant(kMolecules, 0.7), Eigen::VectorXd::Constant(kMolecules, 0.3);
  MeanSquareDisplacement motion(mass, molecule);
  for (int frame = 0; frame < kFrames; ++frame) {
    Vectors both(3, 2 * kMolecules);
    both << x.colwise() + Vec3(0.3, 0, 0), x.colwise() - Vec3(0.7, 0, 0);
    motion.see(h * frame, both);
    for (int m = 0; m < kMolecules; ++m) {
      const Vec3 one = random.normal_vector(), other = random.normal_vector();
      x.col(m) += v.col(m) * (1 - c) / kGamma + b * one + std::sqrt(var_x - b * b) * other;
      v.col(m) = c * v.col(m) + std::sqrt(var_v) * one;
    }
  }
  const auto result = motion.result();
  ASSERT_EQ(result.t.size(), 50u);
  for (std::size_t k = 0; k < result.t.size(); ++k) {
    const double gt = kGamma * result.t[k];
    const double exact = 6 * kT / (kGamma * kGamma) * (gt - 1 + std::exp(-gt));
    EXPECT_GT(result.squared[k].error, 0);
    EXPECT_NEAR(result.squared[k].value, exact, 5 * result.squared[k].error) << result.t[k];
    EXPECT_NEAR(result.squared[k].value, exact, 0.05 * exact) << result.t[k];
  }
  const double d = kT / kGamma;
  EXPECT_NEAR(result.diffusion.value, d, 4 * result.diffusion.error);
  EXPECT_NEAR(result.diffusion.value, d, 0.05 * d);
  EXPECT_LT(result.diffusion.error, 0.05 * d);
  EXPECT_NEAR(result.exponent, 1, 0.1);
}

TEST(Measures, TooFewFramesHaveNoDiffusion) {
  MeanSquareDisplacement motion(Eigen::VectorXd::Ones(1), {0});
  for (int frame = 0; frame < 39; ++frame) motion.see(frame, Vectors::Zero(3, 1));
  EXPECT_TRUE(motion.result().t.empty());
  motion.see(39, Vectors::Zero(3, 1));
  EXPECT_EQ(motion.result().t.size(), 2u);
}

// Atoms anywhere: g = 1 at every distance, of two kinds and without those of the same molecule, which here
// are on top of each other.
TEST(Measures, AnIdealGasOfTwoKindsHasAFlatDistribution) {
  constexpr int kMolecules = 40;
  const Box box{Vec3(2, 2.5, 3)};
  std::vector<int> a = numbers(kMolecules), b = a, molecule = a;
  for (int& atom : b) atom += kMolecules;
  molecule.insert(molecule.end(), molecule.begin(), molecule.end());
  RadialDistribution pairs(a, b, molecule, 1);
  Random random(3);
  for (int frame = 0; frame < 300; ++frame) {
    Vectors x(3, 2 * kMolecules);
    for (int m = 0; m < kMolecules; ++m)
      x.col(m) = x.col(m + kMolecules) = box.edge.cwiseProduct(random.uniform_vector());
    pairs.see(frame, x, box);
  }
  const Distances g = pairs.result();
  double mean = 0;
  for (std::size_t n = 50; n < 100; ++n) {
    EXPECT_NEAR(g.g[n].value, 1, 6 * g.g[n].error);
    mean += g.g[n].value / 50;
  }
  EXPECT_NEAR(mean, 1, 0.02);
  EXPECT_EQ(g.g[0].value, 0) << "partners of a molecule are left out";
}

// Chains that forget their ends within 50 frames, seen for 200: each R² is an AR(1) process of mean 10 and
// spread 2, so that its mean over the frames has a spread known in closed form. Blocks of 20 frames see a
// third of it.
TEST(Measures, ErrorsOfSlowChainsAreNotTooSmall) {
  constexpr int kChains = 400, kFrames = 200;
  const double rho = std::exp(-1.0 / 50);
  Random random(7);
  std::vector<std::array<int, 2>> ends;
  for (int c = 0; c < kChains; ++c) ends.push_back({2 * c, 2 * c + 1});
  EndToEnd chains(ends);
  std::vector<double> squared(kChains), means;
  for (double& r2 : squared) r2 = 10 + 2 * random.normal_vector().x();
  Vectors x = Vectors::Zero(3, 2 * kChains);
  for (int frame = 0; frame < kFrames; ++frame) {
    for (int c = 0; c < kChains; ++c) {
      x(0, 2 * c + 1) = std::sqrt(squared[static_cast<std::size_t>(c)]);
      squared[static_cast<std::size_t>(c)] += (1 - rho) * (10 - squared[static_cast<std::size_t>(c)]) +
                                              2 * std::sqrt(1 - rho * rho) * random.normal_vector().x();
    }
    chains.see(frame, x);
  }
  double correlated = 0;
  for (int i = 0; i < kFrames; ++i)
    for (int j = 0; j < kFrames; ++j) correlated += std::pow(rho, std::abs(i - j)) / kFrames / kFrames;
  const double exact = 2 * std::sqrt(correlated / kChains);
  EXPECT_NEAR(chains.squared().value, 10, 4 * exact);
  EXPECT_NEAR(chains.squared().error, exact, 0.15 * exact);
}

// In cells as pair by pair, in a skewed box too.
TEST(Measures, CellsMissNoPair) {
  const Box box{Vec3(4, 3.6, 3.3), Vec3(-1.3, 1.7, 0.9)};
  const int n = 300;
  Random random(9);
  Vectors x(3, n);
  for (int a = 0; a < n; ++a) x.col(a) = 9 * random.uniform_vector() - Vec3(3, 3, 3);
  std::vector<int> molecule = numbers(n), some(molecule.begin(), molecule.begin() + 200);
  for (int a = 0; a < n; a += 2) molecule[static_cast<std::size_t>(a + 1)] = a;
  for (const auto& other : {some, numbers(n)}) {
    RadialDistribution pairs(some, other, molecule, 0.95);
    pairs.see(0, x, box);
    const Distances g = pairs.result();
    std::vector<double> count(g.r.size(), 0.0);
    double all = 0;
    for (const int i : some)
      for (const int j : other) {
        if (molecule[static_cast<std::size_t>(i)] == molecule[static_cast<std::size_t>(j)] ||
            (other == some && j > i))
          continue;
        ++all;
        const double r = box.nearest_image(x.col(i) - x.col(j)).norm();
        if (r < 0.95) ++count[static_cast<std::size_t>(r / 0.01)];
      }
    for (std::size_t k = 0; k < g.r.size(); ++k) {
      const double low = g.r[k] - 0.005, high = g.r[k] + 0.005;
      const double ideal = all * 4 / 3 * std::numbers::pi * (std::pow(high, 3) - std::pow(low, 3));
      EXPECT_NEAR(g.g[k].value * ideal / box.volume(), count[k], 1e-9 * (1 + count[k])) << k;
    }
  }
}

// Frames come back as they were written, to single precision; a frame cut short is none.
TEST(Measures, ATrajectoryReadsBack) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "trajectory.dcd";
  const System sys = make_system(Eigen::VectorXd::Ones(2), {});
  const Names names = guessed_names({1.0, 1.0}, {0, 1});
  State s;
  Eigen::Matrix3d vectors;
  vectors << 2, 0.5, -0.7, 0, 1.8, 0.3, 0, 0, 1.5;
  s.box = Box::of(vectors);
  s.x.resize(3, 2);
  s.x << 0.125, 1, 2, 3, -4, 5;
  {
    DcdFile dcd(file, {sys, names, 0.002, 50, 0, true}, 0);
    for (int frame = 0; frame < 2; ++frame, s.x *= 2) dcd.add({frame * 50L, s, Eigen::VectorXd()});
  }
  DcdReader reader(file);
  EXPECT_EQ(reader.atoms(), 2);
  EXPECT_NEAR(reader.time_of(1) - reader.time_of(0), 0.1, 1e-7);
  Vectors x;
  Box box;
  ASSERT_TRUE(reader.next(x, box));
  EXPECT_TRUE(x.isApprox(s.x / 4, 1e-6));
  EXPECT_TRUE(box.vectors().isApprox(vectors, 1e-6)) << box.vectors();
  ASSERT_TRUE(reader.next(x, box));
  EXPECT_TRUE(x.isApprox(s.x / 2, 1e-6));
  EXPECT_FALSE(reader.next(x, box));
  DcdReader second(file);
  EXPECT_EQ(second.frames(), 2);
  second.skip();
  ASSERT_TRUE(second.next(x, box));
  EXPECT_TRUE(x.isApprox(s.x / 2, 1e-6));
  EXPECT_TRUE(box.vectors().isApprox(vectors, 1e-6));
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 1);
  DcdReader cut(file);
  EXPECT_EQ(cut.frames(), 1);
  EXPECT_TRUE(cut.next(x, box));
  EXPECT_FALSE(cut.next(x, box));
  EXPECT_THROW(DcdReader(folder.write("other.dcd", "no trajectory")), InputError);
}

}  // namespace
}  // namespace taut::measures_tests
