#include "systems/whole_molecules.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "error_message.hpp"

namespace taut::whole_molecules_tests {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const Box kBox{.edge = {2, 3, 4}};

TEST(WholeMolecules, AreFoundByEveryKindOfBond) {
  const System sys = make_system(Eigen::VectorXd::Ones(8), {{0, 5, 0.1}});
  Terms terms;
  terms.bonds.push_back({5, 1, 0.1, 1});
  terms.fene.push_back({3, 6, 1, 1});
  const auto pairs = bonded_pairs(sys, terms);
  EXPECT_EQ(pairs.size(), 3u);
  EXPECT_THAT(molecules(8, pairs), ElementsAre(0, 0, 1, 2, 3, 0, 2, 4));
}

// A chain that runs through several boxes, and rings, broken at random and mended.
TEST(WholeMolecules, AreMendedByWholeEdges) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> step(-0.4, 0.4);
  std::uniform_int_distribution<int> images(-3, 3);
  constexpr int n = 400;
  Vectors whole(3, n);
  std::vector<BondedPair> pairs;
  for (int a = 0; a < n; ++a) {
    whole.col(a) = Vec3(step(random), step(random), step(random));
    if (a % 200 == 0) continue;  // two molecules
    whole.col(a) += whole.col(a - 1) + Vec3(0.4, 0, 0);
    pairs.push_back({a, a - 1});
    if (a % 2 == 0 && (whole.col(a) - whole.col(a - 2)).cwiseAbs().x() < 1) pairs.push_back({a - 2, a});
  }
  Vectors x = whole;
  for (int a = 0; a < n; ++a)
    if (a % 200 != 0)
      x.col(a) += Vec3(images(random), images(random), images(random)).cwiseProduct(kBox.edge);
  make_whole(kBox, pairs, x);
  EXPECT_LT((x - whole).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_GT(std::abs(x(0, 199)), 10 * kBox.edge.x());

  Vectors again = x;
  make_whole(kBox, pairs, again);
  EXPECT_EQ(again, x) << "what is whole stays, to the bit";
}

TEST(WholeMolecules, StayAsTheyAreWithoutABox) {
  Vectors x(3, 2);
  x << 0, 9, 0, 9, 0, 9;
  const Vectors before = x;
  make_whole(Box{}, {{0, 1}}, x);
  EXPECT_EQ(x, before);
}

TEST(WholeMolecules, AreRefusedWhereTheyMeetTheirOwnImage) {
  Vectors x = Vectors::Zero(3, 4);
  x.row(0) << 0, 0.5, 1.0, 1.5;  // a ring around the edge of 2
  EXPECT_THAT(error_message([&] {
                make_whole(kBox, {{0, 1}, {1, 2}, {2, 3}, {3, 0}}, x);
              }),
              HasSubstr("meets its own image"));
}

}  // namespace
}  // namespace taut::whole_molecules_tests
