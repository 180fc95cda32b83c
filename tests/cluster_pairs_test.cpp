#include "forcefield/clusters/machines.hpp"
// before Highway
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <set>
#include <string>

#include "every_machine.hpp"
#include "forcefield/clusters/atom_clusters.hpp"
#include "forcefield/clusters/cluster_pairs.hpp"
#include "forcefield/lennard_jones_coulomb.hpp"
#include "forcefield/wca.hpp"
#include "md/errors.hpp"
#include "md/threads.hpp"
#include "md/units.hpp"

// Forces and energies of the clusters, against the plain loops over pairs.

namespace taut {
namespace {

using testing::on_every_machine;
using testing::on_one_to_three_threads;

struct Liquid {
  const char* name;
  int molecules;   // along an edge, of three atoms
  double spacing;  // [nm]
  bool periodic;
  double cutoff;     // [nm]; 0: none
  double switch_at;  // [nm]; 0: none
  int sigmas;        // kinds of atoms with Lennard-Jones; 0: no Lennard-Jones at all
  bool charges;
};

void PrintTo(const Liquid& liquid, std::ostream* out) {
  *out << liquid.name;
}

// Bent molecules of three on a jittered lattice, turned at random, some of them boxes away. No two atoms of
// different molecules come near enough for forces that drown the others.
Vectors place(const Liquid& liquid, std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  const int m = liquid.molecules;
  Vectors x(3, 3 * m * m * m);
  const auto direction = [&] { return Vec3(normal(rng), normal(rng), normal(rng)).normalized(); };
  for (int k = 0; k < m * m * m; ++k) {
    Vec3 o = liquid.spacing * (Vec3(k % m, k / m % m, k / m / m) + 0.06 * direction());
    if (liquid.periodic) o += m * liquid.spacing * Vec3(k % 3 - 1, k % 5 - 2, k % 2);
    x.col(3 * k) = o;
    x.col(3 * k + 1) = o + 0.1 * direction();
    x.col(3 * k + 2) = o + 0.1 * direction();
  }
  return x;
}

Nonbonded forces_of(const Liquid& liquid) {
  const int n = 3 * liquid.molecules * liquid.molecules * liquid.molecules;
  Nonbonded nb;
  nb.charge.setZero(n);
  nb.sigma.setConstant(n, 0.25);
  nb.epsilon.setZero(n);
  for (int a = 0; a < n; ++a) {
    if (liquid.charges) nb.charge[a] = a % 3 == 0 ? -0.8 : 0.4;
    if (liquid.sigmas > 0 && a % 3 == 0) nb.epsilon[a] = a % 2 == 0 ? 0.6 : 0.3;
    if (liquid.sigmas > 1 && a % 3 == 0) nb.sigma[a] = a % 4 == 0 ? 0.25 : 0.21;
    if (a % 3 != 0) nb.exceptions.push_back({a - a % 3, a, 0, 1, 0});
    if (a % 3 == 2) nb.exceptions.push_back({a - 1, a, 0, 1, 0});
    if (a % 9 == 3) nb.exceptions.push_back({a, (a + 5) % n, 0, 1, 0});
  }
  if (liquid.cutoff > 0) nb.cutoff = liquid.cutoff;
  if (liquid.switch_at > 0) nb.switch_distance = liquid.switch_at;
  return nb;
}

Box box_of(const Liquid& liquid) {
  return liquid.periodic ? Box{Vec3::Constant(liquid.molecules * liquid.spacing)} : Box{};
}

double rms(const Vectors& f) {
  return f.norm() / std::sqrt(f.size());
}

// Which atoms have no pair so near the cutoff that one precision may count it and the other not: 1, else 0.
Eigen::RowVectorXd clear_of_cutoff(double cutoff, const Vectors& x, const Box& box) {
  Eigen::RowVectorXd clear = Eigen::RowVectorXd::Ones(x.cols());
  for (int i = 0; cutoff > 0 && i < x.cols(); ++i)
    for (int j = 0; j < i; ++j) {
      const double r2 = box.nearest_image(x.col(i) - x.col(j)).squaredNorm();
      if (std::abs(r2 / (cutoff * cutoff) - 1) < 2e-6) clear[i] = clear[j] = 0;
    }
  return clear;
}

// Σ r·f of pairs at their nearest images, pair by pair: −r dE/dr of LennardJonesCoulomb's equations.
double virial_of_pairs(const Nonbonded& nb, const Box& box, const Vectors& x) {
  std::set<std::pair<int, int>> excluded;
  for (const auto& e : nb.exceptions) excluded.insert(std::minmax(e.i, e.j));
  const double rc = nb.cutoff.value_or(HUGE_VAL), rs = nb.switch_distance.value_or(rc),
               eps = nb.rf_dielectric;
  const double k_rf = nb.cutoff ? (eps - 1) / ((2 * eps + 1) * rc * rc * rc) : 0;
  double sum = 0;
  for (int i = 0; i < x.cols(); ++i)
    for (int j = i + 1; j < x.cols(); ++j) {
      const double r = box.nearest_image(x.col(i) - x.col(j)).norm();
      if (r > rc || excluded.contains({i, j})) continue;
      const double s6 = std::pow((nb.sigma[i] + nb.sigma[j]) / 2 / r, 6);
      const double four_eps = 4 * std::sqrt(nb.epsilon[i] * nb.epsilon[j]);
      const double u = r > rs ? (r - rs) / (rc - rs) : 0, left = 1 - u * u * u * (10 - 15 * u + 6 * u * u);
      const double fall = r > rs ? 30 * u * u * (1 - u) * (1 - u) * r / (rc - rs) : 0;  // −r dS/dr
      sum += four_eps * s6 * ((12 * s6 - 6) * left + (s6 - 1) * fall);
      sum += kCoulomb * nb.charge[i] * nb.charge[j] * (1 / r - 2 * k_rf * r * r);
    }
  return sum;
}

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
};

TEST_P(ClusterPairsIn, AgreesWithThePlainLoopWhileAtomsMove) {
  on_every_machine([&] {
    ClusterPairs clusters(nb, box, Precision::kDouble);
    LennardJonesCoulomb plain(nb, box);
    Vectors moved = x;
    for (int n = 0; n < 40; ++n) {
      Vectors f = Vectors::Zero(3, x.cols()), witness = f;
      clusters.add_forces(moved, f);
      const double energy = plain.add(moved, witness);
      EXPECT_LT((f - witness).cwiseAbs().maxCoeff(), 1e-13 * witness.cwiseAbs().maxCoeff()) << n;
      EXPECT_LT((f - witness).norm(), 1e-13 * witness.norm()) << n;
      if (n % 5 == 0) {
        EXPECT_NEAR(clusters.energy(), energy, 1e-11 * std::abs(energy));
      }
      moved += step();
    }
    if (liquid.cutoff > 0) {
      EXPECT_GT(clusters.searches(), 0);
      EXPECT_GT(clusters.prunings(), clusters.searches());
      EXPECT_LT(clusters.prunings(), 40);
    }
  });
}

TEST_P(ClusterPairsIn, AgreesInMixedPrecisionToItsDigits) {
  on_every_machine([&] {
    ClusterPairs clusters(nb, box, Precision::kMixed);
    LennardJonesCoulomb plain(nb, box);
    Vectors moved = x;
    for (int n = 0; n < 5; ++n) {
      Vectors f = Vectors::Zero(3, x.cols()), witness = f;
      clusters.add_forces(moved, f);
      const double energy = plain.add(moved, witness);
      const Eigen::RowVectorXd clear = clear_of_cutoff(liquid.cutoff, moved, box);
      EXPECT_LT(rms((f - witness) * clear.asDiagonal()), 1e-5 * rms(witness)) << n;
      EXPECT_GT(rms(f - witness), 1e-12 * rms(witness)) << "is it mixed?";
      EXPECT_NEAR(clusters.energy(), energy, 1e-5 * std::abs(energy));
      moved += step();
    }
  });
}

TEST_P(ClusterPairsIn, HasTheVirialOfItsPairs) {
  const double expected = virial_of_pairs(nb, box, x);
  on_every_machine([&] {
    on_one_to_three_threads([&] {
      for (const auto& [precision, digits] :
           {std::pair{Precision::kDouble, 1e-11}, std::pair{Precision::kMixed, 1e-5}}) {
        ClusterPairs clusters(nb, box, precision);
        Vectors f = Vectors::Zero(3, x.cols());
        clusters.add_forces(x, f);
        EXPECT_NEAR(clusters.virial(), expected, digits * std::abs(expected));
      }
    });
  });
}

TEST_P(ClusterPairsIn, GivesTheSameBitsTwiceOnAnyNumberOfThreads) {
  LennardJonesCoulomb plain(nb, box);
  Vectors witness = Vectors::Zero(3, x.cols());
  const double energy = plain.add(x, witness);
  const Eigen::RowVectorXd clear = clear_of_cutoff(liquid.cutoff, x, box);
  on_every_machine([&] {
    on_one_to_three_threads([&] {
      for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
        ClusterPairs one(nb, box, precision), other(nb, box, precision);
        Vectors f = Vectors::Zero(3, x.cols()), g = f;
        one.add_forces(x, f);
        other.add_forces(x, g);
        EXPECT_EQ(f, g);
        EXPECT_EQ(one.energy(), other.energy());
        const double digits = precision == Precision::kDouble ? 2e-14 : 1e-5;
        EXPECT_LT(rms((f - witness) * clear.asDiagonal()), digits * rms(witness));
        EXPECT_NEAR(one.energy(), energy, 10 * digits * std::abs(energy));
        const Vectors moved = x + step();
        one.add_forces(moved, f);
        other.add_forces(moved, g);
        EXPECT_EQ(f, g);
      }
    });
  });
}

// Whichever thread has it, and where nothing else moves.
TEST_P(ClusterPairsIn, MissesNoPairOfOneAtomThatGoesFar) {
  on_one_to_three_threads([&] {
    ClusterPairs clusters(nb, box, Precision::kDouble);
    LennardJonesCoulomb plain(nb, box);
    Vectors moved = x, f = Vectors::Zero(3, x.cols());
    clusters.add_forces(moved, f);
    for (int a = 1; a < x.cols(); a += static_cast<int>(x.cols()) / 6)
      for (const double step : {0.02, 0.05, 0.4}) {
        moved.col(a) += step * Vec3(2, -1, 2) / 3;
        Vectors witness = Vectors::Zero(3, x.cols());
        f.setZero();
        clusters.add_forces(moved, f);
        plain.add(moved, witness);
        EXPECT_LT((f.col(a) - witness.col(a)).norm(), 1e-11 * witness.norm()) << a;
        EXPECT_LT((f - witness).norm(), 1e-11 * witness.norm()) << a;
      }
  });
}

const auto kLiquids =
    ::testing::Values(Liquid{"water_barely_two_cutoffs", 5, 0.33, true, 0.82, 0, 1, true},
                      Liquid{"water_two_and_a_half_cutoffs", 6, 0.33, true, 0.8, 0, 1, true},
                      Liquid{"water_many_cutoffs", 9, 0.33, true, 0.5, 0, 1, true},
                      Liquid{"switched", 6, 0.33, true, 0.8, 0.6, 1, true},
                      Liquid{"two_sigmas", 6, 0.33, true, 0.8, 0, 2, true},
                      Liquid{"two_sigmas_switched_without_charges", 6, 0.33, true, 0.8, 0.6, 2, false},
                      Liquid{"without_lennard_jones", 6, 0.33, true, 0.8, 0, 0, true},
                      Liquid{"droplet", 7, 0.33, false, 0.7, 0, 1, true},
                      Liquid{"everything_with_everything", 5, 0.33, false, 0, 0, 2, true});
INSTANTIATE_TEST_SUITE_P(Liquids, ClusterPairsIn, kLiquids,
                         [](const auto& test) { return std::string(test.param.name); });

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
        ClusterPairs clusters(wca, n, box, precision);
        WcaBeads plain(wca, n, box);
        Vectors moved = x;
        for (int step = 0; step < 10; ++step) {
          Vectors f = Vectors::Zero(3, n), witness = f;
          clusters.add_forces(moved, f);
          const double energy = plain.add(moved, witness);
          const double digits = precision == Precision::kDouble ? 2e-14 : 1e-5;
          EXPECT_LT((f - witness).norm(), digits * witness.norm());
          EXPECT_NEAR(clusters.energy(), energy, digits * 10 * energy);
          for (int a = 0; a < n; ++a) moved.col(a) += 0.02 * Vec3(normal(rng), normal(rng), normal(rng));
        }
      }
    });
  }
}

// Two atoms, or two drops, come from beyond all lists' reach with any speed, each its half of the way, so
// that lists are used as long as they may be: the first force must not be late.
TEST(ClusterPairs, MissNoPairOfThoseThatMeet) {
  std::mt19937_64 rng(9);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return Vec3(normal(rng), normal(rng), normal(rng)).normalized(); };
  for (const int drop : {1, 1, 1, 5, 30})
    for (const Box& box : {Box{}, Box{Vec3(2.2, 2.5, 3)}}) {
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
          ClusterPairs clusters(nb, box, Precision::kDouble);
          LennardJonesCoulomb plain(nb, box);
          Vectors moved = x;
          for (double way = 0; way < 0.25; way += speed) {
            Vectors f = Vectors::Zero(3, n), witness = f;
            clusters.add_forces(moved, f);
            plain.add(moved, witness);
            ASSERT_LE((f - witness).norm(), 1e-12 * witness.norm()) << way << " " << speed << " " << drop;
            moved.leftCols(drop).colwise() += speed * along;
            moved.rightCols(drop).colwise() -= speed * along;
          }
        });
      }
    }
}

TEST(ClusterPairs, AtomsFarApartAndUnevenlySpread) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  const int n = 300;
  Vectors x(3, n);
  for (int a = 0; a < n; ++a) {
    const double scale = a < 150 ? 1.5 : a < 250 ? 6 : 300;
    x.col(a) = scale * Vec3(uniform(rng), uniform(rng), uniform(rng));
  }
  x.col(7) = Vec3(1e6, -2e6, 3e6);
  Nonbonded nb;
  nb.charge = Eigen::VectorXd::Constant(n, 0.1);
  nb.sigma = Eigen::VectorXd::Constant(n, 0.1);
  nb.epsilon = Eigen::VectorXd::Zero(n);
  nb.cutoff = 0.7;
  ClusterPairs clusters(nb, {}, Precision::kDouble);
  LennardJonesCoulomb plain(nb, {});
  Vectors f = Vectors::Zero(3, n), witness = f;
  clusters.add_forces(x, f);
  plain.add(x, witness);
  EXPECT_LT((f - witness).norm(), 1e-12 * witness.norm());
}

// There a float is known to 0.06 nm: more than the inner buffer.
TEST(ClusterPairs, MissNoPairFarFromTheOrigin) {
  const Liquid droplet{"", 7, 0.33, false, 0.7, 0, 1, true};
  std::mt19937_64 rng(11);
  std::normal_distribution<double> normal(0, 0.003);
  Vectors x = place(droplet, rng);
  x.array() += 1e6;
  const Nonbonded nb = forces_of(droplet);
  ClusterPairs clusters(nb, {}, Precision::kDouble);
  LennardJonesCoulomb plain(nb, {});
  for (int n = 0; n < 20; ++n) {
    Vectors f = Vectors::Zero(3, x.cols()), witness = f;
    clusters.add_forces(x, f);
    plain.add(x, witness);
    EXPECT_LT((f - witness).norm(), 1e-12 * witness.norm()) << n;
    x += Vectors::NullaryExpr(3, x.cols(), [&] { return normal(rng); });
  }
}

// The error of forces in mixed precision, against the plain loop in double: a share of them.
double mixed_error(const Nonbonded& nb, const Box& box, const Vectors& x) {
  ClusterPairs clusters(nb, box, Precision::kMixed);
  LennardJonesCoulomb plain(nb, box);
  Vectors f = Vectors::Zero(3, x.cols()), witness = f;
  clusters.add_forces(x, f);
  const double energy = plain.add(x, witness);
  EXPECT_NEAR(clusters.energy(), energy, 1e-5 * std::abs(energy));
  const Eigen::RowVectorXd clear = clear_of_cutoff(nb.cutoff.value_or(0), x, box);
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
      x.col(a) = extent.cwiseProduct(Vec3(uniform(rng), uniform(rng), uniform(rng)));
      x.col(a + 1) = x.col(a) + 0.3 * Vec3(normal(rng), normal(rng), normal(rng)).normalized();
    }
    EXPECT_LT(mixed_error(nb, {}, x), 1e-6) << extent.transpose();
    EXPECT_LT(mixed_error(nb, {extent.cwiseMax(2)}, x), 1e-6) << extent.transpose();
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
  AtomClusters clusters({{}, range, std::vector<std::uint8_t>(n, 1), std::vector<std::uint8_t>(n, 0)});
  clusters.build(x);
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

TEST(ClusterPairs, RefusesPositionsThatAreNotFinite) {
  const Liquid liquid{"", 5, 0.33, true, 0.8, 0, 1, true};
  std::mt19937_64 rng(1);
  Vectors x = place(liquid, rng), f = Vectors::Zero(3, x.cols());
  for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
    ClusterPairs clusters(forces_of(liquid), box_of(liquid), precision);
    clusters.add_forces(x, f);
    Vectors bad = x;
    bad(1, 12) = std::nan("");
    EXPECT_THROW(clusters.add_forces(bad, f), SimulationFailure);
    bad(1, 12) = HUGE_VAL;
    EXPECT_THROW(clusters.add_forces(bad, f), SimulationFailure);
  }
}

}  // namespace
}  // namespace taut
