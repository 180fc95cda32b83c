// Molecules made whole across the box, and rings that go through each other, against Gauss's integral.

#include "systems/molecules/whole_molecules.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "base/errors.hpp"
#include "base/listen.hpp"
#include "base/random.hpp"
#include "error_message.hpp"
#include "force_checks.hpp"
#include "systems/molecules/linked_rings.hpp"

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

// A ring around the edge of 2 nm with a whole dumbbell beside it, and a dumbbell and a site in it.
TEST(WholeMolecules, SayWhichMeetTheirOwnImage) {
  using enum Reach;
  Vectors x = Vectors::Zero(3, 7);
  x.row(0) << 0, 0.5, 1.0, 1.5, 0.1, 2.2, 3.5;
  const std::vector<Tether> springs = {spring(0, 1), spring(1, 2), spring(2, 3), spring(3, 0),
                                       rigid(4, 5, 0.1)};
  Vectors moved = x;
  EXPECT_THAT(make_whole(kBox, springs, moved),
              testing::ElementsAre(kMolecule, kMolecule, kMolecule, kMolecule, kWhole, kWhole, kWhole));
  EXPECT_EQ(moved.leftCols(4), x.leftCols(4));
  EXPECT_NEAR(moved(0, 5), 0.2, 1e-12);

  std::vector<Tether> mixed = springs;
  mixed[3] = rigid(3, 0, 0.5);  // a cluster of two, across the box
  mixed.push_back({3, 6, Tether::By::kSite});
  EXPECT_THAT(make_whole(kBox, mixed, moved = x),
              testing::ElementsAre(kMolecule, kMolecule, kMolecule, kMolecule, kWhole, kWhole, kMolecule));
  EXPECT_NEAR(std::abs(moved(0, 3) - moved(0, 0)), 0.5, 1e-12);
  EXPECT_NEAR(moved(0, 6), moved(0, 3), 1e-12);

  std::vector<Tether> all = springs;
  for (int k = 0; k < 4; ++k) all[k] = rigid(k, (k + 1) % 4, 0.5);
  all.push_back({3, 6, Tether::By::kSite});
  EXPECT_THAT(make_whole(kBox, all, moved = x),
              testing::ElementsAre(kCluster, kCluster, kCluster, kCluster, kWhole, kWhole, kCluster));
  EXPECT_NEAR(moved(0, 6), moved(0, 3), 1e-12);
}

TEST(WholeMolecules, RefuseABondOverHalfTheBoxWhereTheyMeetTheirOwnImage) {
  Vectors x = columns({{0, 0, 0}, {1.05, 0, 0}});
  EXPECT_EQ(error_message([&] { make_whole(kBox, {rigid(0, 1, 1.05)}, x); }), "no error") << "does not";
  Vectors three = columns({{0, 0, 0}, {1.05, 0, 0}, {1.5, 0, 0}});
  EXPECT_THAT(error_message([&] {
                make_whole(kBox, {rigid(0, 1, 1.05), spring(1, 2), spring(2, 0)}, three);
              }),
              HasSubstr("their bond of 1.05 nm is over half the box"));
}

// Sites on each bond of a ring around the box, of rigid bonds, of springs, or on nothing else; with one bond free of them
// what they tie is whole.
TEST(WholeMolecules, RefuseSitesThatChainAroundTheBox) {
  for (const auto by : {Tether::By::kBond, Tether::By::kSpring, Tether::By::kSite})
    for (const int sites : {4, 3}) {
      Vectors x = Vectors::Zero(3, 8);
      std::vector<Tether> tethers;
      for (int a = 0; a < 4; ++a) {
        const int next = (a + 1) % 4;
        x(0, a) = 0.5 * a, x(0, 4 + a) = 0.5 * a + 0.2;
        if (by != Tether::By::kSite) tethers.push_back({a, next, by, 0.5});
        if (a >= sites) continue;
        tethers.push_back({a, 4 + a, Tether::By::kSite});
        tethers.push_back({a, next, Tether::By::kSite});
      }
      EXPECT_THAT(error_message([&] { make_whole(kBox, tethers, x); }),
                  HasSubstr(sites == 4 ? "atoms 3 and 0: virtual sites tie" : "no error"));
    }
  // A site between the ends of a chain that is longer than half the box is between them as they are.
  Vectors chain = Vectors::Zero(3, 5);
  chain.row(0) << 0, 0.5, 1.0, 1.5, 0.75;
  const Vectors as_given = chain;
  make_whole(kBox,
             {spring(0, 1), spring(1, 2), spring(2, 3), {0, 4, Tether::By::kSite}, {0, 3, Tether::By::kSite}},
             chain);
  EXPECT_EQ(chain, as_given);
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
// tell where the ends are.
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
  EXPECT_EQ(make_whole(kBox, tethers, x)[0], Reach::kMolecule) << "a bond that goes around the box";
}

Vectors circle(int atoms, double radius, const Vec3& centre, const Vec3& u, const Vec3& v) {
  Vectors x(3, atoms);
  for (int k = 0; k < atoms; ++k) {
    const double phi = 2 * std::numbers::pi * (k + 0.3) / atoms;
    x.col(k) = centre + radius * (std::cos(phi) * u + std::sin(phi) * v);
  }
  return x;
}

struct Rings {
  std::vector<RigidBond> bonds;
  Vectors x = Vectors(3, 0);

  void add(const Vectors& ring) {
    const int first = static_cast<int>(x.cols()), n = static_cast<int>(ring.cols());
    x.conservativeResize(3, first + n);
    x.rightCols(n) = ring;
    for (int k = 0; k < n; ++k) bonds.push_back({first + k, first + (k + 1) % n, 1});
  }
  // A chain of two atoms that hangs on the last atom.
  void add_side_chain() {
    const int n = static_cast<int>(x.cols());
    x.conservativeResize(3, n + 2);
    for (const int a : {n, n + 1}) x.col(a) = x.col(a - 1) + Vec3(0.1, 0, 0), bonds.push_back({a - 1, a, 1});
  }
  LinkedRings found(const Box& box = {}) const {
    State s;
    s.x = x, s.box = box;
    return find_linked_rings(make_system(Eigen::VectorXd::Ones(x.cols()), bonds), {}, s);
  }
};

const Vec3 ex(1, 0, 0), ey(0, 1, 0), ez(0, 0, 1);

TEST(LinkedRings, AreThoseThatGoThroughEachOther) {
  Rings rings;
  rings.add(circle(20, 1, Vec3::Zero(), ex, ey));
  rings.add_side_chain();
  rings.add(circle(12, 1, Vec3(1, 0, 0), ex, ez));  // through the first
  rings.add(circle(12, 1, Vec3(3.5, 0, 0), ex, ez));
  rings.add(circle(20, 0.9, Vec3(0, 0, 0.1), ex, ey));  // beside the first one, and around the second
  const LinkedRings found = rings.found();
  EXPECT_EQ(found.rings, 4);
  EXPECT_EQ(found.pairs, 2);
  EXPECT_EQ(found.atom_of_one, 0);
  EXPECT_EQ(found.atom_of_other, 22);

  Rings small;
  small.add(circle(7, 1, Vec3::Zero(), ex, ey));
  small.add(circle(7, 1, Vec3(1, 0, 0), ex, ez));
  EXPECT_EQ(small.found().rings, 0);
}

// Across the box: an image of the second ring goes through the first, whichever image of each atom the start has.
TEST(LinkedRings, MayBeLinkedThroughTheBox) {
  const Box box{Vec3(3, 3.2, 3.4), Vec3(0.3, -0.4, 0.2)};
  Rings rings;
  rings.add(circle(16, 1, Vec3(0.1, 0, 0), ex, ey));
  rings.add(circle(16, 1, Vec3(1.1, 0, 0) + box.lattice_vector({1, -2, 1}), ex, ez));
  EXPECT_EQ(rings.found().pairs, 0);
  EXPECT_EQ(rings.found(box).pairs, 1);
  for (Eigen::Index a = 0; a < rings.x.cols(); a += 3) rings.x.col(a) += box.lattice_vector({-1, 1, 0});
  EXPECT_EQ(rings.found(box).pairs, 1);

  Rings wide;  // one that goes through its own images, as chain mail does
  Vectors tilted = circle(16, 1.9, Vec3::Zero(), ex, ey);
  for (Eigen::Index a = 0; a < tilted.cols(); ++a)
    tilted(2, a) = std::sin(2 * std::atan2(tilted(1, a), tilted(0, a)));
  wide.add(tilted);
  const Box narrow{Vec3(3, 3, 9)};
  EXPECT_EQ(wide.found().pairs, 0);
  EXPECT_EQ(wide.found(narrow).pairs, 2);  // along x and along y
}

// 1/4π ∮∮ r₁₂·(dr₁ × dr₂)/|r₁₂|³, summed over short pieces of the bonds.
double gauss_integral(const Vectors& one, const Vectors& two) {
  constexpr int kPieces = 40;
  double sum = 0;
  const auto bond = [](const Vectors& x, Eigen::Index k) {
    return std::pair<Vec3, Vec3>(x.col(k), x.col((k + 1) % x.cols()) - x.col(k));
  };
  for (Eigen::Index i = 0; i < one.cols(); ++i)
    for (Eigen::Index j = 0; j < two.cols(); ++j) {
      const auto [p, a] = bond(one, i);
      const auto [q, b] = bond(two, j);
      for (int s = 0; s < kPieces; ++s)
        for (int t = 0; t < kPieces; ++t) {
          const Vec3 r = p + (s + 0.5) / kPieces * a - q - (t + 0.5) / kPieces * b;
          sum += r.dot(a.cross(b)) / (kPieces * kPieces * std::pow(r.norm(), 3));
        }
    }
  return sum / (4 * std::numbers::pi);
}

TEST(LinkedRings, AreThoseOfGausssIntegral) {
  Random random(7);
  int linked = 0;
  for (int k = 0; k < 30; ++k) {
    Rings rings;
    Vectors pair[2] = {Vectors(3, 8), Vectors(3, 9)};
    for (Vectors& x : pair) {
      for (Eigen::Index a = 0; a < x.cols(); ++a) x.col(a) = random.uniform_vector();
      rings.add(x);
    }
    const double integral = gauss_integral(pair[0], pair[1]);
    if (std::abs(integral - std::round(integral)) > 0.2) continue;  // bonds that nearly touch
    EXPECT_EQ(rings.found().pairs, std::round(integral) == 0 ? 0 : 1) << k << " " << integral;
    linked += std::round(integral) != 0;
  }
  EXPECT_GT(linked, 5);
}

TEST(LinkedRings, AreSaidWherePairsKeepBondsApart) {
  Rings rings;
  rings.add(circle(20, 1, Vec3::Zero(), ex, ey));
  rings.add(circle(20, 1, ex, ex, ez));
  State s;
  s.x = rings.x;
  const System sys = make_system(Eigen::VectorXd::Ones(40), rings.bonds);
  Terms terms;
  EXPECT_EQ(linked_rings_message(sys, terms, s), "");
  terms.wca = Wca{1, 1, {}};
  EXPECT_THAT(linked_rings_message(sys, terms, s),
              testing::StartsWith(
                  "a pair of the 2 rings is linked, the first those of atoms 0 and 20, and stays so"));
  const ListenScope stopping([] { throw InputError("stop"); });
  EXPECT_THROW(linked_rings_message(sys, terms, s), InputError);
}

}  // namespace
}  // namespace taut::whole_molecules_tests
