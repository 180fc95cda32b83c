#include "forcefield/pairs/cluster_pairs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "error_message.hpp"
#include "every_machine.hpp"
#include "forcefield/pairs/cluster_list.hpp"
#include "liquids.hpp"
#include "md/largest_system.hpp"
#include "reference/plain_pairs.hpp"

// Forces and energies of the clusters, against the plain loop over pairs.

namespace taut::cluster_pairs_tests {
namespace {

using namespace tests;

class ClusterPairsIn : public ::testing::TestWithParam<Liquid> {
 protected:
  std::mt19937_64 rng{7};
  Liquid liquid = GetParam();
  Nonbonded nb = forces_of(liquid);
  Box box = box_of(liquid);
  Vectors x = place(liquid, rng);

  Vectors step() {  // of hydrogens in a hurry
    std::normal_distribution<double> normal(0, 0.003);
    return Vectors::NullaryExpr(3, x.cols(), [&] { return normal(rng); });
  }

  struct Frame {
    Box box;
    Vectors x;
    PairSums plain;
  };
  std::vector<Frame> wander(int steps) {
    std::vector<Frame> frames;
    for (Vectors moved = x; static_cast<int>(frames.size()) < steps; moved += step())
      frames.push_back({box, moved, plain_pairs(nb, box, moved)});
    return frames;
  }
};

TEST_P(ClusterPairsIn, AgreesWithThePlainLoopWhileAtomsMove) {
  const auto frames = wander(40);
  on_every_machine([&] {
    ClusterPairs clusters(nb, box.periodic(), Precision::kDouble);
    for (int n = 0; n < 40; ++n) {
      const auto& [in, moved, plain] = frames[n];
      Vectors f = Vectors::Zero(3, x.cols());
      clusters.add_forces(moved, in, f);
      EXPECT_LT((f - plain.f).cwiseAbs().maxCoeff(), 2e-13 * plain.f.cwiseAbs().maxCoeff()) << n;
      EXPECT_LT((f - plain.f).norm(), 1e-13 * plain.f.norm()) << n;
      if (n % 5 == 0) {
        EXPECT_NEAR(clusters.energy(), plain.energy, 1e-11 * std::abs(plain.energy));
      }
    }
    if (liquid.cutoff > 0) {
      EXPECT_GT(clusters.searches(), 0);
      EXPECT_GT(clusters.prunings(), clusters.searches());
      EXPECT_LT(clusters.prunings(), 40);
    }
  });
}

// The box shrinks from 1.6 times its width, atoms at rest in it, until pairs that the outer list left out come into
// range; then, as under a barostat, it is a little wider or narrower at every step, sheared where it is skewed.
TEST_P(ClusterPairsIn, AgreesWithThePlainLoopWhileTheBoxChanges) {
  if (!box.periodic()) return;
  std::vector<Frame> frames;
  std::uniform_real_distribution<double> change(-0.002, 0.002);
  constexpr int kShrinking = 12, kBreathing = 25;
  const Box narrowest = box;
  for (int n = 0; n < kShrinking + kBreathing; ++n) {
    Box to = narrowest.scaled(Vec3::Constant(1.6 - 0.6 * n / kShrinking));
    if (n >= kShrinking) {
      to = narrowest.scaled(Vec3(1.002, 1.002, 1.002) + Vec3(change(rng), change(rng), change(rng)));
      if (!to.tilt.isZero()) to.tilt.x() += 0.3 * change(rng);
      x += step() / 3;
    }
    for (int a = 0; a < x.cols(); ++a) x.col(a) = to.lattice_vector(box.fractional(x.col(a)));
    box = to;
    frames.push_back({box, x, plain_pairs(nb, box, x)});
  }
  on_every_machine([&] {
    ClusterPairs clusters(nb, true, Precision::kDouble), mixed(nb, true, Precision::kMixed);
    long searches = 0;
    for (std::size_t n = 0; n < frames.size(); ++n) {
      const auto& [in, moved, plain] = frames[n];
      Vectors f = Vectors::Zero(3, x.cols()), g = f;
      clusters.add_forces(moved, in, f);
      EXPECT_LT((f - plain.f).norm(), 1e-13 * plain.f.norm()) << n;
      EXPECT_LT((clusters.virial() - plain.virial).norm(), 1e-11 * plain.virial.norm()) << n;
      mixed.add_forces(moved, in, g);
      EXPECT_LT(rms((g - plain.f) * plain.clear.asDiagonal()), 1e-5 * rms(plain.f)) << n;
      if (n == kShrinking) searches = clusters.searches();
    }
    EXPECT_LT(clusters.searches() - searches, 0.5 * kBreathing) << "the outer list follows the box";
  });
}

TEST_P(ClusterPairsIn, AgreesInMixedPrecisionToItsDigits) {
  const auto frames = wander(5);
  on_every_machine([&] {
    ClusterPairs clusters(nb, box.periodic(), Precision::kMixed);
    for (int n = 0; n < 5; ++n) {
      const auto& [in, moved, plain] = frames[n];
      Vectors f = Vectors::Zero(3, x.cols());
      clusters.add_forces(moved, in, f);
      EXPECT_LT(rms((f - plain.f) * plain.clear.asDiagonal()), 1e-5 * rms(plain.f)) << n;
      EXPECT_GT(rms(f - plain.f), 1e-12 * rms(plain.f)) << "is it mixed?";
      EXPECT_NEAR(clusters.energy(), plain.energy, 1e-5 * std::abs(plain.energy));
    }
  });
}

TEST_P(ClusterPairsIn, GivesTheSameBitsTwiceOnAnyNumberOfThreads) {
  const PairSums plain = plain_pairs(nb, box, x);
  on_every_machine([&] {
    on_one_to_three_threads([&] {
      for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
        ClusterPairs one(nb, box.periodic(), precision), other(nb, box.periodic(), precision);
        Vectors f = Vectors::Zero(3, x.cols()), g = f;
        one.add_forces(x, box, f);
        other.add_forces(x, box, g);
        EXPECT_EQ(f, g);
        EXPECT_EQ(one.energy(), other.energy());
        const double digits = precision == Precision::kDouble ? 2e-14 : 1e-5;
        EXPECT_LT(rms((f - plain.f) * plain.clear.asDiagonal()), digits * rms(plain.f));
        EXPECT_NEAR(one.energy(), plain.energy, 10 * digits * std::abs(plain.energy));
        EXPECT_LT((one.virial() - plain.virial).norm(), std::max(1e-11, digits) * plain.virial.norm());
        const Vectors moved = x + step();
        one.add_forces(moved, box, f);
        other.add_forces(moved, box, g);
        EXPECT_EQ(f, g);
      }
    });
  });
}

const auto kLiquids =
    ::testing::Values(Liquid{"water_barely_two_cutoffs", 5, 0.33, true, 0.82, 0, 1, true},
                      Liquid{"water_two_and_a_half_cutoffs", 6, 0.33, true, 0.8, 0, 1, true},
                      Liquid{"water_many_cutoffs", 9, 0.33, true, 0.5, 0, 1, true},
                      Liquid{"skewed_barely_two_cutoffs", 5, 0.33, true, 0.82, 0, 1, true, {0.5, -0.5, 0.5}},
                      Liquid{"skewed", 7, 0.33, true, 0.8, 0.6, 2, true, {-0.31, 0.44, 0.27}},
                      Liquid{"octahedron", 9, 0.33, true, 0.5, 0, 1, true, {1.0 / 3, -1.0 / 3, 0.5}},
                      Liquid{"switched", 6, 0.33, true, 0.8, 0.6, 1, true},
                      Liquid{"switched_without_charges", 9, 0.33, true, 0.8, 0.6, 1, false},
                      Liquid{"two_sigmas", 6, 0.33, true, 0.8, 0, 2, true},
                      Liquid{"two_sigmas_switched_without_charges", 6, 0.33, true, 0.8, 0.6, 2, false},
                      Liquid{"by_a_table", 6, 0.33, true, 0.8, 0, 3, true},
                      Liquid{"by_a_table_switched_without_charges", 6, 0.33, true, 0.8, 0.6, 3, false},
                      Liquid{"without_lennard_jones", 6, 0.33, true, 0.8, 0, 0, true},
                      Liquid{"droplet", 7, 0.33, false, 0.7, 0, 1, true},
                      Liquid{"everything_with_everything", 5, 0.33, false, 0, 0, 2, true});
INSTANTIATE_TEST_SUITE_P(Liquids, ClusterPairsIn, kLiquids,
                         [](const auto& test) { return std::string(test.param.name); });

// Two states of one atom, or a site on its parent: wherever in their clusters they come to be, and whichever
// slots of those are left over.
TEST(ClusterPairs, ExcludedAtomsMayBeInOnePlace) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> jitter(-0.05, 0.05);
  const Box box{Vec3::Constant(1.3), Vec3(0.4, -0.3, 0.5)};
  const auto expect_agreement = [&](Nonbonded nb, const Vectors& x) {
    for (const double cutoff : {0.0, 0.6})
      for (const bool periodic : {false, true}) {
        nb.cutoff.reset();
        if (cutoff > 0) nb.cutoff = cutoff;
        const Box in = periodic ? box : Box{};
        const PairSums plain = plain_pairs(nb, in, x);
        ASSERT_TRUE(plain.f.allFinite() && plain.f.norm() > 0);
        on_every_machine([&] {
          for (const auto& [precision, digits] :
               {std::pair{Precision::kDouble, 1e-13}, std::pair{Precision::kMixed, 1e-5}}) {
            ClusterPairs clusters(nb, periodic, precision);
            Vectors f = Vectors::Zero(3, x.cols());
            clusters.add_forces(x, in, f);
            EXPECT_LT(((f - plain.f) * plain.clear.asDiagonal()).norm(), digits * plain.f.norm());
            EXPECT_NEAR(clusters.energy(), plain.energy, 100 * digits * plain.f.norm());
            EXPECT_LT((clusters.virial() - plain.virial).norm(), 100 * digits * plain.virial.norm());
          }
        });
      }
  };
  for (int n = 4; n < 10; ++n)
    for (int first = 0; first + 1 < n; ++first)
      for (int together = 2; together <= std::min(3, n - first); ++together) {
        SCOPED_TRACE(::testing::Message()
                     << together << " atoms in one place of " << n << ", from " << first);
        Nonbonded nb;
        nb.sigma = Eigen::VectorXd::Constant(n, 0.2);
        nb.epsilon = Eigen::VectorXd::Constant(n, 0.5);
        nb.charge = Eigen::VectorXd::LinSpaced(n, -0.7, 0.8);
        Vectors x(3, n);
        for (int a = 0; a < n; ++a) {
          x.col(a) = 0.3 * Vec3(a % 3, a / 3 % 3, a % 2) + Vec3(jitter(rng), jitter(rng), jitter(rng));
          if (a <= first || a >= first + together) continue;
          x.col(a) = x.col(first);
          for (int b = first; b < a; ++b) nb.exceptions.push_back({b, a, 0, 1, 0});
        }
        expect_agreement(nb, x);
      }
}

TEST(ClusterPairs, WcaAgreesWithThePlainLoop) {
  std::mt19937_64 rng(3);
  std::normal_distribution<double> normal;
  for (const int side : {3, 5, 11}) {
    const int n = side * side * side;
    const Box box{Vec3::Constant(1.0 * side)};
    Wca wca{1, 1.5, {}};
    for (int a = 0; a + 1 < n; a += 3) wca.exclusions.push_back({a, a + 1});
    Vectors x(3, n);
    for (int a = 0; a < n; ++a)
      x.col(a) = Vec3(a % side, a / side % side, a / side / side) +
                 0.05 * Vec3(normal(rng), normal(rng), normal(rng));
    on_every_machine([&] {
      for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
        ClusterPairs clusters(wca, n, box.periodic(), precision);
        Vectors moved = x;
        for (int step = 0; step < 10; ++step) {
          const auto [energy, virial, witness, clear] = plain_wca(wca, box, moved);
          Vectors f = Vectors::Zero(3, n);
          clusters.add_forces(moved, box, f);
          const double digits = precision == Precision::kDouble ? 2e-14 : 1e-5;
          EXPECT_LT((clusters.virial() - virial).norm(), digits * 10 * virial.norm());
          EXPECT_LT((f - witness).norm(), digits * witness.norm());
          EXPECT_NEAR(clusters.energy(), energy, digits * 10 * energy);
          for (int a = 0; a < n; ++a) moved.col(a) += 0.02 * Vec3(normal(rng), normal(rng), normal(rng));
        }
      }
    });
  }
}

// Rows number their j-clusters with 32 bits: a longer list is refused before there is memory for it.
TEST(ClusterList, RefusesMoreThanItsRowsCanNumber) {
  ClusterList list;
  list.make_room(1000);
  EXPECT_EQ(list.clusters.size(), 1000u);
  EXPECT_EQ(error_message([&] { list.make_room(std::size_t(1) << 31); }),
            "the pair list of a thread is longer than taut can number (2^31 entries): take a shorter cutoff "
            "or more "
            "threads");
  EXPECT_EQ(list.clusters.size(), 1000u);
}

// Neither an index nor a list overflows: what is too large is refused before there is memory for it.
TEST(LargestSystem, IsRefusedPast) {
  EXPECT_EQ(error_message([] { refuse_more_atoms(kMostAtoms); }), "no error");
  EXPECT_EQ(error_message([] { refuse_more_atoms(kMostAtoms + 1); }),
            "a system of 10000001 atoms, more than the 10000000 taut takes: build fewer copies");
}

}  // namespace
}  // namespace taut::cluster_pairs_tests
