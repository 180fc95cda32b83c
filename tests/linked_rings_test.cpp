// Rings that go through each other, against Gauss's integral.

#include "systems/molecules/linked_rings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "base/errors.hpp"
#include "base/random.hpp"

namespace taut::linked_rings_tests {
namespace {

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
  EXPECT_THROW(linked_rings_message(sys, terms, s, [] { throw InputError("stop"); }), InputError);
}

}  // namespace
}  // namespace taut::linked_rings_tests
