#include "base/random.hpp"

#include <gtest/gtest.h>

namespace taut {
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

}  // namespace
}  // namespace taut
