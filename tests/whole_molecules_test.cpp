#include "systems/molecules/whole_molecules.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "error_message.hpp"
#include "force_checks.hpp"

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

Tether rigid(int i, int j, double length) {
  return {i, j, Tether::By::kBond, length};
}
Tether spring(int i, int j, double length = 0) {
  return {i, j, Tether::By::kSpring, length};
}

// A chain that runs through several boxes, and rings, broken at random and mended.
TEST(WholeMolecules, AreMendedByWholeEdges) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> step(-0.4, 0.4);
  std::uniform_int_distribution<int> images(-3, 3);
  constexpr int n = 400;
  Vectors whole(3, n);
  std::vector<Tether> pairs;
  for (int a = 0; a < n; ++a) {
    whole.col(a) = Vec3(step(random), step(random), step(random));
    if (a % 200 == 0) continue;  // two molecules
    whole.col(a) += whole.col(a - 1) + Vec3(0.4, 0, 0);
    pairs.push_back(spring(a, a - 1));
    if (a % 2 == 0 && (whole.col(a) - whole.col(a - 2)).cwiseAbs().x() < 1) pairs.push_back(spring(a - 2, a));
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
  make_whole(Box{}, {spring(0, 1)}, x);
  EXPECT_EQ(x, before);
}

TEST(WholeMolecules, AreRefusedWhereTheyMeetTheirOwnImage) {
  Vectors x = Vectors::Zero(3, 4);
  x.row(0) << 0, 0.5, 1.0, 1.5;  // a ring around the edge of 2
  EXPECT_THAT(error_message([&] {
                make_whole(kBox, {spring(0, 1), spring(1, 2), spring(2, 3), spring(3, 0)}, x);
              }),
              HasSubstr("meets its own image"));
}

void expect_kept(const std::vector<Tether>& tethers, const Vectors& x) {
  Vectors moved = x;
  make_whole(kBox, tethers, moved);
  EXPECT_EQ(moved, x);
}

// Rigid bonds of 1.4 nm in an edge of 2 nm: as they are where that fits, to the bit.
TEST(WholeMolecules, KeepBondsLongerThanHalfTheBox) {
  const Vectors x = columns({{0.1, 0.2, 0.3}, {1.5, 0.2, 0.3}, {2.2, 0.2 + 0.7 * std::sqrt(3), 0.3}});
  expect_kept({rigid(0, 1, 1.4)}, x.leftCols(2));
  expect_kept({rigid(0, 1, 1.4), rigid(0, 2, (x.col(2) - x.col(0)).norm())}, x);
  expect_kept({rigid(0, 1, 1.38)}, x.leftCols(2));  // off by more than 1 %, and no image is nearer
  expect_kept({spring(0, 1, 1.5)}, x.leftCols(2));  // one stretched by nothing
  expect_kept({{0, 1, Tether::By::kStrut, 1.2}}, x.leftCols(2));
}

// Atoms wrapped one by one come to the one image that has the bond's length, through boxes and in a tilted one.
TEST(WholeMolecules, TakeTheImageThatHasTheBondsLength) {
  const Vectors whole = columns({{0.1, 0.2, 0.3}, Vec3(0.1, 0.2, 0.3) + 1.4 * Vec3(2, 1, 2) / 3});
  for (const Box& box : {kBox, Box{.edge = {2, 3, 4}, .tilt = {0.9, -0.7, 1.1}}})
    for (const Vec3& cell : {Vec3(-1, 0, 0), Vec3(3, -2, 1), Vec3(0, 500, 0)}) {
      Vectors x = whole;
      x.col(1) += box.lattice_vector(cell);
      make_whole(box, {rigid(0, 1, 1.4)}, x);
      EXPECT_LT((x - whole).cwiseAbs().maxCoeff(), 1e-12);
      make_whole(box, {spring(0, 1, 1.38)}, x);
      EXPECT_LT((x - whole).cwiseAbs().maxCoeff(), 1e-12);
    }
}

TEST(WholeMolecules, RefuseABondThatNoImageFitsOrTwo) {
  const auto refusal = [](double length, const Vec3& to) {
    Vectors x = columns({Vec3::Zero(), to});
    return error_message([&] { make_whole(kBox, {rigid(0, 1, length)}, x); });
  };
  EXPECT_THAT(refusal(1.3, {0.8, 0.2, 0}),
              HasSubstr("atoms 0 and 1 are 0.8246 nm apart, and none of their images"));
  EXPECT_THAT(refusal(std::hypot(1, 1.2), {3, 1.2, 0}),
              HasSubstr("more than one of their images has the length"));
}

// A chain of short springs whose ends are held 1.4 nm apart, and a site between two atoms as far: wrapped, the springs
// tell where the ends are; what goes around the box is refused as ever.
TEST(WholeMolecules, CloseRingsOfLongBonds) {
  Vectors whole(3, 8);
  std::vector<Tether> tethers;
  for (int a = 0; a < 8; ++a) {
    whole.col(a) << 0.2 * a, 0.3 * (a % 2), 0;
    if (a > 0) tethers.push_back(spring(a - 1, a, 0.36));
  }
  tethers.push_back(rigid(0, 7, (whole.col(7) - whole.col(0)).norm()));
  tethers.push_back({0, 7, Tether::By::kSite});
  expect_kept(tethers, whole);
  Vectors x = whole;
  x.row(0).array() -= 2 * (x.row(0).array() / 2 + 0.5).floor();
  make_whole(kBox, tethers, x);
  EXPECT_LT((x - whole).cwiseAbs().maxCoeff(), 1e-12);
  tethers[7].length = 0.7;
  EXPECT_THAT(error_message([&] { make_whole(kBox, tethers, x); }), HasSubstr("meets its own image"));
}

}  // namespace
}  // namespace taut::whole_molecules_tests
