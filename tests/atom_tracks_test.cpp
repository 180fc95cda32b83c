#include <gtest/gtest.h>

#include <random>
#include <string>

#include "base/errors.hpp"
#include "every_machine.hpp"
#include "forcefield/pairs/cluster_pairs.hpp"
#include "liquids.hpp"
#include "reference/plain_pairs.hpp"

// Lists are made for where atoms are going. No pair is missed, wherever they go instead.

namespace taut::atom_tracks_tests {
namespace {

using namespace tests;

// A liquid of light and heavy atoms in flight.
class Flight {
 public:
  const Liquid liquid{"water", 6, 0.33, true, 0.8, 0, 1, true};
  const Nonbonded nb = forces_of(liquid);
  Box box = box_of(liquid);
  Vectors x, v;  // v: the way of a step [nm]

  Flight() {
    std::normal_distribution<double> normal;
    x = place(liquid, rng_);
    v = Vectors::NullaryExpr(3, x.cols(), [&] { return normal(rng_); });
    for (int a = 0; a < x.cols(); ++a) v.col(a) *= a % 3 == 0 ? 0.0006 : 0.0025;
  }

  void expect_all_pairs(ClusterPairs& clusters) const {
    const Vectors witness = plain_pairs(nb, box, x).f;
    EXPECT_LT((forces(clusters) - witness).norm(), 1e-13 * witness.norm());
  }
  Vectors forces(ClusterPairs& clusters) const {
    Vectors f = Vectors::Zero(3, x.cols());
    clusters.add_forces(x, box, f);
    return f;
  }
  void turn() {  // each atom another way, as after a collision
    std::normal_distribution<double> normal;
    for (int a = 0; a < x.cols(); ++a)
      v.col(a) = v.col(a).norm() * Vec3(normal(rng_), normal(rng_), normal(rng_)).normalized();
  }
  ClusterPairs clusters(Precision precision = Precision::kDouble) const {
    return {nb, box.periodic(), precision};
  }

 private:
  std::mt19937_64 rng_{7};
};

// Calls until the inner list has been made anew `prunings` times, of a flight that `disturb` may disturb
// after each.
int calls_of(Flight& flight, ClusterPairs& clusters, int prunings, const auto& disturb) {
  flight.expect_all_pairs(clusters);
  int calls = 0;
  for (long last = clusters.prunings(), end = last + prunings; last < end && calls < 200; ++calls) {
    flight.x += flight.v;
    flight.expect_all_pairs(clusters);
    if (std::exchange(last, clusters.prunings()) != last) disturb();
  }
  return calls;
}

TEST(AtomTracks, MissNoPairOfAtomsThatFlyStraightAndServeThemLong) {
  on_every_machine([&] {
    Flight flight;
    ClusterPairs clusters = flight.clusters();
    calls_of(flight, clusters, 4, [] {});  // until it is known how fast they are
    EXPECT_GE(calls_of(flight, clusters, 6, [] {}), 30);
  });
}

TEST(AtomTracks, LookLessFarAheadWhereAtomsThatStoodBeginToMove) {
  Flight flight;
  ClusterPairs clusters = flight.clusters();
  const Vectors v = 0.0025 * flight.v.colwise().normalized();
  flight.v = 1e-3 * v;
  flight.v.col(1) = v.col(1);
  calls_of(flight, clusters, 4, [] {});
  flight.v = v;
  calls_of(flight, clusters, 3, [] {});
  const int calls = calls_of(flight, clusters, 3, [] {});
  EXPECT_GE(calls, 15);
  EXPECT_LE(calls, 24);  // more with the margins of atoms that may go anywhere
}

TEST(AtomTracks, MissNoPairWhereAllTurnRoundJustAfterAPruning) {
  on_every_machine([&] {
    on_one_to_three_threads([&] {
      Flight flight;
      ClusterPairs clusters = flight.clusters();
      EXPECT_LE(calls_of(flight, clusters, 8, [&] { flight.v = -flight.v; }), 30);
    });
  });
}

TEST(AtomTracks, MissNoPairWhereAllAreDeflected) {
  Flight flight;
  ClusterPairs clusters = flight.clusters();
  calls_of(flight, clusters, 12, [&] { flight.turn(); });
}

TEST(AtomTracks, MissNoPairOfAtomsThatJumpOrChangeTheirStep) {
  on_every_machine([&] {
    Flight flight;
    ClusterPairs clusters = flight.clusters();
    int n = 0;
    calls_of(flight, clusters, 16, [&] {
      ++n;
      const int a = 31 * n;
      if (n % 4 == 0) flight.x.col(a) += Vec3(0.013, -0.007, 0.01);
      if (n % 4 == 1) flight.x.col(a) += flight.box.lattice_vector(Vec3(1, 0, -1)) + Vec3(0, 0.21, 0);
      if (n % 4 == 2) flight.v *= 2.5;
      if (n % 4 == 3) flight.v *= 0.4;
    });
  });
}

TEST(AtomTracks, MissNoPairInABoxThatChanges) {
  on_every_machine([&] {
    Flight flight;
    ClusterPairs clusters = flight.clusters();
    for (int n = 0; n < 30; ++n) {
      flight.x += flight.v;
      if (n % 5 == 4) {
        const double scale = n % 2 ? 1.004 : 0.997;
        flight.box.edge *= scale;
        flight.x *= scale;
      }
      flight.expect_all_pairs(clusters);
    }
  });
}

// To the last bit, whenever it was kept: just before a pruning or a search, just after, between.
TEST(AtomTracks, GoOnFromWhatWasKept) {
  for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
    Flight flight;
    ClusterPairs clusters = flight.clusters(precision);
    std::vector<Vectors> x, f;
    std::vector<std::string> kept;
    std::vector<long> prunings;
    for (int n = 0; n < 30; ++n, flight.x += flight.v) {
      x.push_back(flight.x);
      f.push_back(flight.forces(clusters));
      prunings.push_back(clusters.prunings());
      Archive save = Archive::saving_to(kept.emplace_back());
      clusters.serialize(save);
    }
    EXPECT_GT(clusters.searches(), 1);
    for (std::size_t n = 0; n < kept.size(); ++n) {
      ClusterPairs other = flight.clusters(precision);
      flight.x = x[0];
      flight.forces(other);
      Archive load = Archive::loading_from(kept[n]);
      other.serialize(load);
      load.finish();
      const long before = other.prunings() - prunings[n];
      for (std::size_t m = n; m < kept.size(); ++m) {
        flight.x = x[m];
        ASSERT_EQ(flight.forces(other), f[m]) << n << ' ' << m;
        ASSERT_EQ(other.prunings() - before, prunings[m]) << n << ' ' << m;
      }
    }
  }
}

TEST(AtomTracks, RefuseWhatWasKeptOfMarginsWiderThanTheSearch) {
  Flight flight;
  ClusterPairs clusters = flight.clusters();
  flight.forces(clusters);
  std::string kept;
  Archive save = Archive::saving_to(kept);
  clusters.serialize(save);
  const float wide = 0.5;  // the last of all: a margin
  kept.replace(kept.size() - sizeof wide, sizeof wide, reinterpret_cast<const char*>(&wide), sizeof wide);
  Archive load = Archive::loading_from(kept);
  EXPECT_THROW(clusters.serialize(load), InputError);
}

}  // namespace
}  // namespace taut::atom_tracks_tests
