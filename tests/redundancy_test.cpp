#include "constraints/redundancy.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "constraints/bond_algebra.hpp"
#include "free_system.hpp"

namespace taut::redundancy_tests {
namespace {

// All pairs in `bonds` held at the distance they have in x, masses random.
System braced(const Vectors& x, const std::vector<std::array<int, 2>>& pairs) {
  Random random(2);
  Eigen::VectorXd mass(x.cols());
  for (auto& m : mass) m = 1 + random.uniform();
  std::vector<RigidBond> bonds;
  for (const auto& [i, j] : pairs) bonds.push_back({i, j, (x.col(j) - x.col(i)).norm()});
  return make_system(mass, bonds);
}

std::vector<std::array<int, 2>> all_pairs(int atoms) {
  std::vector<std::array<int, 2>> pairs;
  for (int i = 0; i < atoms; ++i)
    for (int j = i + 1; j < atoms; ++j) pairs.push_back({i, j});
  return pairs;
}

Vectors methane() {
  Vectors x(3, 5);
  x << 0, 1, 1, -1, -1,  //
      0, 1, -1, 1, -1,   //
      0, 1, -1, -1, 1;
  return 0.063 * x;
}

Vectors hexagon(double pucker) {
  Vectors x(3, 6);
  for (int i = 0; i < 6; ++i) x.col(i) << std::cos(M_PI * i / 3), std::sin(M_PI * i / 3), pucker * (i % 2);
  return 0.14 * x;
}

std::vector<std::array<int, 2>> ring_with_second_neighbours() {
  std::vector<std::array<int, 2>> pairs;
  for (int i = 0; i < 6; ++i) pairs.push_back({i, (i + 1) % 6});
  for (int i = 0; i < 6; ++i) pairs.push_back({i, (i + 2) % 6});
  return pairs;
}

TEST(Redundancy, MethaneFullyBracedHasOneBondTooMany) {
  const System sys = braced(methane(), all_pairs(5));
  const Redundancy found = find_redundancy(sys, methane());
  EXPECT_EQ(found.redundant.size(), 1u);
  EXPECT_TRUE(found.degenerate.empty());
  EXPECT_EQ(found.rank(sys), 9);
  EXPECT_NE(explain(found, sys).find("drop"), std::string::npos);
}

TEST(Redundancy, ARingBracedIsDegenerateOnlyWhileFlat) {
  const System flat = braced(hexagon(0), ring_with_second_neighbours());
  const Redundancy found = find_redundancy(flat, hexagon(0));
  EXPECT_EQ(found.degenerate.size(), 3u);  // 12 bonds, but a plane hexagon bears 2·6 − 3
  EXPECT_TRUE(found.redundant.empty());
  EXPECT_NE(explain(found, flat).find("bend the start"), std::string::npos);

  const System puckered = braced(hexagon(0.3), ring_with_second_neighbours());
  EXPECT_TRUE(find_redundancy(puckered, hexagon(0.3)).none());
}

TEST(Redundancy, AFlatRingAloneIsSound) {
  std::vector<std::array<int, 2>> ring;
  for (int i = 0; i < 6; ++i) ring.push_back({i, (i + 1) % 6});
  EXPECT_TRUE(find_redundancy(braced(hexagon(0), ring), hexagon(0)).none());
}

TEST(Redundancy, AStraightAngleHeldByItsEndsIsDegenerate) {
  Vectors x = Vectors::Zero(3, 3);
  x(0, 1) = 0.1;
  x(0, 2) = 0.25;
  const System sys = braced(x, {{0, 1}, {1, 2}, {0, 2}});
  const Redundancy found = find_redundancy(sys, x);
  EXPECT_EQ(found.degenerate.size(), 1u);
  EXPECT_TRUE(found.redundant.empty());
}

// Two bonds within 1e-4 rad of a line brace no third.
TEST(Redundancy, CountsALineToATenThousandthOfARadian) {
  for (const double bend : {3e-5, 1e-3}) {
    Vectors x = Vectors::Zero(3, 3);
    x.col(1) << 0.1, 0, 0;
    x.col(2) << 0.1 + 0.15 * std::cos(bend), 0.15 * std::sin(bend), 0;
    const System sys = braced(x, {{0, 1}, {1, 2}, {0, 2}});
    EXPECT_EQ(find_redundancy(sys, x).none(), bend > 1e-4) << bend;
  }
}

Vectors cube() {
  Vectors x(3, 8);
  for (int n = 0; n < 8; ++n) x.col(n) << (n >> 2 & 1), (n >> 1 & 1), (n & 1);
  return 0.2 * x;
}

// Edges, both diagonals of each face, and `more`.
std::vector<std::array<int, 2>> cube_bonds(std::vector<std::array<int, 2>> more) {
  std::vector<std::array<int, 2>> pairs;
  for (const auto& [i, j] : all_pairs(8))
    if ((cube().col(j) - cube().col(i)).norm() < 0.29) pairs.push_back({i, j});
  pairs.insert(pairs.end(), more.begin(), more.end());
  return pairs;
}

// 8 atoms of a rigid body bear 18 bonds, whatever the symmetry of their placement: the flat faces make which
// bonds follow here another matter than which follow elsewhere, but not how many.
TEST(Redundancy, ACubeWithAllItsDiagonalsHoldsByEighteen) {
  for (const auto& more : {std::vector<std::array<int, 2>>{}, {{0, 7}}, {{0, 7}, {1, 6}, {2, 5}, {3, 4}}})
    for (int turn = 0; turn < 8; ++turn) {  // the bonds in other orders
      std::vector<std::array<int, 2>> pairs = cube_bonds(more);
      std::rotate(pairs.begin(), pairs.begin() + 3 * turn, pairs.end());
      const System sys = braced(cube(), pairs);
      const Redundancy found = find_redundancy(sys, cube());
      EXPECT_TRUE(found.degenerate.empty()) << explain(found, sys);
      EXPECT_EQ(found.rank(sys), 18);
      EXPECT_TRUE(find_redundancy(without(sys, found.redundant), cube()).none());
    }
}

// A flat ring beside a cube on one cluster: what is redundant of it does not hide what is degenerate.
TEST(Redundancy, ACubeTiedToAFlatRingIsDegenerateByTheRing) {
  Vectors x(3, 14);
  x.leftCols(8) = cube();
  x.rightCols(6) = hexagon(0).colwise() + Vec3(0.5, 0.1, 0.05);
  std::vector<std::array<int, 2>> pairs = cube_bonds({{0, 7}});
  for (const auto& [i, j] : ring_with_second_neighbours()) pairs.push_back({8 + i, 8 + j});
  pairs.push_back({7, 11});
  const System sys = braced(x, pairs);
  const Redundancy found = find_redundancy(sys, x);
  EXPECT_EQ(found.redundant.size(), 7u);
  EXPECT_EQ(found.degenerate.size(), 3u);
  for (int k : found.degenerate) EXPECT_GE(k, 25) << "of the cube";
  for (int k : found.redundant) EXPECT_LT(k, 25) << "of the ring";
}

TEST(Redundancy, ManyMoleculesAreEachFound) {
  Vectors x(3, 15);
  for (int m = 0; m < 3; ++m) x.middleCols(5 * m, 5) = methane().colwise() + Vec3(m, 0, 0);
  std::vector<std::array<int, 2>> pairs;
  for (int m = 0; m < 3; ++m)
    for (const auto& [i, j] : all_pairs(5)) pairs.push_back({5 * m + i, 5 * m + j});
  const System sys = braced(x, pairs);
  EXPECT_EQ(find_redundancy(sys, x).redundant.size(), 3u);
}

// Methane with a bond left out: the multipliers spread over all ten give the same force and have least norm.
TEST(Redundancy, LeastNormMultipliersGiveTheSameForce) {
  const Vectors x = methane();
  const System full = braced(x, all_pairs(5));
  const auto left_out = find_redundancy(full, x).redundant;
  const System kept = without(full, left_out);
  ASSERT_EQ(kept.bond_count(), 9);
  Random random(4);
  Eigen::VectorXd lambda(9);
  for (auto& value : lambda) value = random.normal();
  const Eigen::VectorXd spread = least_norm_multipliers(full, x, left_out, lambda);

  const auto force = [&](const System& sys, const Eigen::VectorXd& multipliers) {
    Vectors r(3, sys.bond_count()), f = Vectors::Zero(3, 5);
    differences(sys, x, r);
    add_constraint_force(sys, r, multipliers, f);
    return f;
  };
  EXPECT_LT((force(full, spread) - force(kept, lambda)).norm(), 1e-14);
  EXPECT_GT(std::abs(spread[left_out[0]]), 1e-3);  // it carries its share
  EXPECT_LT(spread.norm(), lambda.norm());
}

}  // namespace
}  // namespace taut::redundancy_tests
