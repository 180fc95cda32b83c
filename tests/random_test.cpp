#include "base/random.hpp"

#include <gtest/gtest.h>

namespace taut::random_tests {
namespace {

// A million numbers: a moment of variance s² is met within 5 s/1000.
constexpr int kMany = 1'000'000;

TEST(Random, NormalNumbersHaveTheirMoments) {
  Random random(1);
  double m1 = 0, m2 = 0, m3 = 0, m4 = 0;
  int beyond_two = 0;
  for (int k = 0; k < kMany; ++k) {
    const double x = random.normal();
    m1 += x / kMany, m2 += x * x / kMany, m3 += x * x * x / kMany, m4 += x * x * x * x / kMany;
    beyond_two += std::abs(x) > 2;
  }
  EXPECT_NEAR(m1, 0, 0.005);
  EXPECT_NEAR(m2, 1, 0.0071);
  EXPECT_NEAR(m3, 0, 0.02);
  EXPECT_NEAR(m4, 3, 0.05);
  EXPECT_NEAR(static_cast<double>(beyond_two) / kMany, std::erfc(std::sqrt(2.0)), 0.0011);
}

TEST(Random, DirectionsAreUniform) {
  Random random(2);
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  Vec3 first = Vec3::Zero();
  for (int k = 0; k < kMany; ++k) {
    const Vec3 u = random.unit_vector();
    ASSERT_NEAR(u.squaredNorm(), 1, 1e-14);
    first += u / kMany;
    second += u * u.transpose() / kMany;
  }
  EXPECT_LT(first.cwiseAbs().maxCoeff(), 0.003);
  EXPECT_LT((second - Eigen::Matrix3d::Identity() / 3).cwiseAbs().maxCoeff(), 0.0015);
}

// The same on every machine, to the last bit.
TEST(Random, SeedDecidesEverything) {
  Random random(1), same(1), other(2);
  EXPECT_EQ(random.normal(), -0.72016742390080624);
  EXPECT_EQ(random.normal(), -1.4973005699809812);
  EXPECT_EQ(random.normal(), 1.0871885747937569);
  EXPECT_EQ(random.uniform(), 0.4707521324902324);
  EXPECT_EQ(same.normal(), -0.72016742390080624);
  EXPECT_NE(other.normal(), -0.72016742390080624);
}

// The known answers of the generator's authors (Random123, kat_vectors).
TEST(Philox, GivesItsAuthorsWords) {
  using Words = std::array<std::uint32_t, 4>;
  EXPECT_EQ(philox({}, {}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

// Seed, stream and step decide; nothing that was drawn before does.
TEST(Philox, NumbersOfAStepDependOnNothingBefore) {
  RandomCounter counter{7};
  std::vector<double> first;
  for (int step = 0; step < 3; ++step) first.push_back(counter.next(Stream::kLangevin).normal());
  EXPECT_EQ(RandomOfStep(7, Stream::kLangevin, 2).normal(), first[2]);
  EXPECT_NE(first[0], first[1]);
  EXPECT_NE(RandomOfStep(7, Stream::kMonteCarlo, 2).normal(), first[2]);
  EXPECT_NE(RandomOfStep(8, Stream::kLangevin, 2).normal(), first[2]);
}

}  // namespace
}  // namespace taut::random_tests
