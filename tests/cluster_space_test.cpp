#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "base/errors.hpp"
#include "every_machine.hpp"
#include "forcefield/pairs/atom_clusters.hpp"
#include "forcefield/pairs/cluster_pairs.hpp"
#include "liquids.hpp"
#include "reference/plain_pairs.hpp"

// Where atoms are: far apart, far away, on the move. No pair of them is missed, whatever lists are kept.

namespace taut::cluster_space_tests {
namespace {

using namespace tests;

// Boxes barely two ranges wide, slabs, threads, clouds; some atoms have drifted boxes away.
struct Space {
  const char* name;
  int atoms;
  Vec3 extent;               // filled with atoms [nm]
  bool periodic;             // the extent is a box
  Vec3 tilt = Vec3::Zero();  // of it [nm]
};

void PrintTo(const Space& space, std::ostream* out) {
  *out << space.name;
}

class ClusterPairsInSpace : public ::testing::TestWithParam<Space> {};

TEST_P(ClusterPairsInSpace, MissNoPairWhileAtomsMove) {
  const Space& space = GetParam();
  const int n = space.atoms;
  const Vec3 extent = space.extent;
  std::mt19937_64 rng(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, 0.008);
  const Box box{space.periodic ? extent : Vec3::Zero(), space.tilt};
  Vectors x(3, n);
  for (int a = 0; a < n; ++a) {
    x.col(a) = extent.cwiseProduct(Vec3(uniform(rng), uniform(rng), uniform(rng)));
    x.col(a) += box.lattice_vector(Vec3(a % 5 - 2, a % 3 - 1, a % 7 - 3));
  }
  Nonbonded nb;
  nb.charge = nb.sigma = nb.epsilon = Eigen::VectorXd::Zero(n);
  for (int a = 0; a < n; ++a) nb.charge[a] = a % 2 ? 0.3 : -0.4;
  nb.cutoff = 0.5;
  on_every_machine([&, start = x] {
    x = start;
    ClusterPairs clusters(nb, box.periodic(), Precision::kDouble);
    for (int step = 0; step < 25; ++step) {
      const auto [energy, virial, witness, clear] = plain_pairs(nb, box, x);
      Vectors f = Vectors::Zero(3, n);
      clusters.add_forces(x, box, f);
      EXPECT_LE((f - witness).norm(), 1e-11 * witness.norm()) << "at step " << step;
      EXPECT_NEAR(clusters.energy(), energy, 1e-9 * (1 + std::abs(energy)));
      x += Vectors::NullaryExpr(3, n, [&] { return normal(rng); });
    }
  });
}

INSTANTIATE_TEST_SUITE_P(Spaces, ClusterPairsInSpace,
                         ::testing::Values(Space{"smallest", 60, {1.0, 1.0, 1.0}, true},
                                           Space{"uneven", 120, {1.4, 1.49, 2.0}, true},
                                           Space{"crowded", 250, {1.81, 1.9, 2.3}, true},
                                           Space{"sparse", 60, {1.81, 1.9, 2.3}, true},
                                           Space{"slab", 250, {1.3, 5.0, 5.0}, true},
                                           Space{"large", 300, {4.0, 5.0, 6.0}, true},
                                           Space{"skewed", 120, {1.0, 1.1, 1.2}, true, {-0.5, 0.5, 0.55}},
                                           Space{"skewed_slab", 250, {1.3, 5.0, 5.0}, true, {0.6, -0.4, 2.4}},
                                           Space{"sheared", 250, {4.0, 1.4, 2.0}, true, {1.9, -1.7, 0.7}},
                                           Space{"nearly_empty", 40, {90, 90, 90}, true},
                                           Space{"drop", 300, {2.0, 2.0, 2.0}, false},
                                           Space{"thread", 300, {30.0, 0.1, 0.1}, false},
                                           Space{"cloud", 200, {5.0, 5.0, 5.0}, false},
                                           Space{"pair", 2, {0.3, 0.3, 0.3}, false}),
                         [](const auto& test) { return std::string(test.param.name); });

// Two atoms, or two drops, come from beyond all lists' reach with any speed, each its half of the way, so
// that lists are used as long as they may be: the first force must not be late.
TEST(ClusterPairs, MissNoPairOfThoseThatMeet) {
  std::mt19937_64 rng(9);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return Vec3(normal(rng), normal(rng), normal(rng)).normalized(); };
  for (const int drop : {1, 1, 1, 5, 30})
    for (const Box& box : {Box{}, Box{Vec3(2.2, 2.5, 3)}, Box{Vec3(2.2, 2.5, 3), Vec3(1.1, -0.9, 1.2)}}) {
      const int n = 2 * drop;
      Nonbonded nb;
      nb.charge = Eigen::VectorXd::Constant(n, 0.4);
      nb.sigma = Eigen::VectorXd::Constant(n, 0.2);
      nb.epsilon = Eigen::VectorXd::Constant(n, 0.5);
      nb.cutoff = 0.8;
      for (const double speed : {0.001, 0.0037, 0.011, 0.026, 0.027, 0.06}) {
        const Vec3 along = direction(), aside = 0.01 * direction();
        Vectors x(3, n);
        for (int a = 0; a < drop; ++a) {
          x.col(a) = 0.15 * std::cbrt(drop - 1) * direction();
          x.col(drop + a) = x.col(a) + aside + 1.2 * along;
        }
        on_every_machine([&] {
          ClusterPairs clusters(nb, box.periodic(), Precision::kDouble);
          Vectors moved = x;
          for (double way = 0; way < 0.25; way += speed) {
            const Vectors witness = plain_pairs(nb, box, moved).f;
            Vectors f = Vectors::Zero(3, n);
            clusters.add_forces(moved, box, f);
            ASSERT_LE((f - witness).norm(), 1e-12 * witness.norm()) << way << " " << speed << " " << drop;
            moved.leftCols(drop).colwise() += speed * along;
            moved.rightCols(drop).colwise() -= speed * along;
          }
        });
      }
    }
}

// The error of forces in mixed precision, against the plain loop in double: a share of them.
double mixed_error(const Nonbonded& nb, const Box& box, const Vectors& x) {
  ClusterPairs clusters(nb, box.periodic(), Precision::kMixed);
  const auto [energy, virial, witness, clear] = plain_pairs(nb, box, x);
  Vectors f = Vectors::Zero(3, x.cols());
  clusters.add_forces(x, box, f);
  EXPECT_NEAR(clusters.energy(), energy, 1e-5 * std::abs(energy));
  return rms((f - witness) * clear.asDiagonal()) / rms(witness);
}

TEST(ClusterPairs, MixedPrecisionDoesNotDependOnTheFarthestAtom) {
  for (const double cutoff : {0.7, 0.0}) {
    const Liquid droplet{"", 5, 0.33, false, cutoff, 0, 1, true};
    std::mt19937_64 rng(11);
    const Nonbonded nb = forces_of(droplet);
    Vectors x = place(droplet, rng);
    const double near = mixed_error(nb, {}, x);
    EXPECT_GT(near, 1e-9) << "is it mixed?";
    EXPECT_LT(near, 2e-6);
    for (const double far : {10.0, 30.0, 60.0, 70.0, 1e3, 1e4, 1e6, 1e9}) {
      SCOPED_TRACE(far);
      Vectors gone = x;
      gone.rightCols(3).colwise() += Vec3(far, -far, 0.3 * far);
      EXPECT_LT(mixed_error(nb, {}, gone), cutoff > 0 || far > 64 ? 1.2 * near : 5e-6);
      gone = x.array() + far;  // all of them, far from the origin
      if (far < 1e5) {
        EXPECT_LT(mixed_error(nb, {}, gone), 1.2 * near);
      }
    }
  }
}

// Pairs of atoms here and there, most with no other in reach: clusters are cut where they would grow wide.
TEST(ClusterPairs, OfAGasAreComputedAsThoseOfALiquid) {
  std::mt19937_64 rng(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto drawn = [&](auto& from) {  // one by one, since compilers differ in the order of arguments
    const double z = from(rng), y = from(rng), x = from(rng);
    return Vec3(x, y, z);
  };
  const int n = 3000;
  Nonbonded nb;
  nb.charge = Eigen::VectorXd::Constant(n, 0.3);
  nb.sigma = Eigen::VectorXd::Constant(n, 0.25);
  nb.epsilon = Eigen::VectorXd::Constant(n, 0.5);
  nb.cutoff = 0.7;
  for (const Vec3& extent :
       {Vec3(1e4, 1e4, 1e4), Vec3(0.5, 0.5, 3e3), Vec3(3e3, 0.5, 0.5), Vec3(1, 1e5, 1e5)}) {
    Vectors x(3, n);
    for (int a = 0; a < n; a += 2) {
      x.col(a) = extent.cwiseProduct(drawn(uniform));
      x.col(a + 1) = x.col(a) + 0.3 * drawn(normal).normalized();
    }
    // single precision leaves 1.3e-6 where products and sums are rounded apart
    EXPECT_LT(mixed_error(nb, {}, x), 1.5e-6) << extent.transpose();
    EXPECT_LT(mixed_error(nb, {extent.cwiseMax(2)}, x), 1.5e-6) << extent.transpose();
  }
  Vectors x = Vectors::Random(3, n) * 1e8;  // where a double is known to 1e-8
  for (int a = 0; a < n; a += 2) x.col(a + 1) = x.col(a) + Vec3(0.3, 0, 0);
  EXPECT_LT(mixed_error(nb, {Vec3::Constant(2e8)}, x), 2e-5);
}

// What is kept of empty space keeps apart what was.
TEST(AtomClusters, LeaveEmptySpaceOut) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  const int n = 200;
  const double range = 0.9;
  Vectors x(3, n);
  for (int a = 0; a < n; ++a) {
    x.col(a) = 3 * Vec3(uniform(rng), uniform(rng), uniform(rng));
    if (a % 7 == 0) x.col(a) += Vec3(1e6, -1e3, 0);
    if (a % 9 == 0) x.col(a) += Vec3(0, 1e5, 1e7);
    if (a == 50) x.col(a) = Vec3(-1e12, 1e12, 0);
  }
  AtomClusters clusters({false, range, std::vector<std::uint8_t>(n, 1), std::vector<std::uint8_t>(n, 0)});
  clusters.build(x, {});
  const auto seen = [&](int a) { return Vec3(x.col(a) + clusters.offset(clusters.slot_of(a))); };
  for (int i = 0; i < n; ++i) {
    EXPECT_LT(seen(i).cwiseAbs().maxCoeff(), 30);
    for (int j = 0; j < i; ++j) {
      const Vec3 was = x.col(i) - x.col(j), is = seen(i) - seen(j);
      if (was.norm() < range) {
        EXPECT_LT((is - was).norm(), 1e-14);
      } else {
        EXPECT_GE(is.norm(), range);
      }
    }
  }
  for (int slot = 0; slot < clusters.slots(); ++slot) {
    const int first = slot / kClusterAtoms * kClusterAtoms;
    EXPECT_LE((seen(clusters.atom(slot)) - seen(clusters.atom(first))).cwiseAbs().maxCoeff(),
              clusters.widest());
  }
}

// Two fours side by side, of heights that alternate: the lowest four are no cluster.
TEST(AtomClusters, AreOfAtomsNearEachOther) {
  Vectors x(3, 8);
  for (int a = 0; a < 8; ++a) x.col(a) = Vec3(a % 2 ? 0.4 : 0.1, 0.25, 0.1 + 0.01 * a);
  AtomClusters clusters({true, 1, std::vector<std::uint8_t>(8, 1), std::vector<std::uint8_t>(8, 0)});
  clusters.build(x, Box{Vec3(1, 1, 2.5)});
  ASSERT_EQ(clusters.count(), 2);
  for (int slot = 0; slot < 8; ++slot) EXPECT_EQ(clusters.atom(slot) % 2, slot / 4);
}

}  // namespace
}  // namespace taut::cluster_space_tests
