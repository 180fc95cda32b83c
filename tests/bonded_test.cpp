// Forces of bonded terms in lanes and by threads, held against the plain loops.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <type_traits>

#include "base/random.hpp"
#include "base/threads.hpp"
#include "error_message.hpp"
#include "every_machine.hpp"
#include "forcefield/bonded/bonded_forces.hpp"
#include "reference/plain_bonded.hpp"

namespace taut::bonded_tests {
namespace {

using std::numbers::pi;
using namespace tests;

// Chains of random walks with every kind of term, all numbers different.
struct Chains {
  Terms terms;
  std::vector<PairException> exceptions;
  Vectors x;

  Chains(int chains, int length) : x(3, chains * length) {
    Random random(7);
    for (int a = 0; a < x.cols(); ++a)
      x.col(a) = a % length == 0 ? Vec3(5 * random.normal_vector())
                                 : Vec3(x.col(a - 1) + 0.15 * random.unit_vector());
    for (int size : {5, 24})
      terms.maps.push_back(Eigen::MatrixXd::NullaryExpr(size, size, [&] { return 20 * random.uniform(); }));
    const auto about = [&](double value) { return value * (0.5 + random.uniform()); };
    const auto table = [&](double first, double last, int points) {
      std::vector<double> energies;
      for (int k = 0; k < points; ++k) energies.push_back(20 * random.uniform());
      return std::make_shared<const Spline>("a.csv", first, last, energies);
    };
    const std::array of_bonds = {table(0.05, 0.25, 3), table(0.1, 0.3, 41)};
    const std::array of_angles = {table(0, pi, 17), table(0, pi, 90)};
    for (int a = 0; a < x.cols(); ++a) {
      const int left = length - 1 - a % length;
      if (left >= 1) terms.bonds.push_back({a, a + 1, about(0.15), about(3000)});
      if (left >= 1) terms.fene.push_back({a + 1, a, about(30), about(0.4)});
      if (left >= 2) terms.angles.push_back({a, a + 1, a + 2, pi * random.uniform(), about(400)});
      if (left >= 2) terms.cosine_angles.push_back({a, a + 1, a + 2, about(20)});
      if (left >= 2)
        terms.cosine_squared_angles.push_back({a, a + 1, a + 2, 2 * random.uniform() - 1, about(20)});
      if (left >= 2) terms.restricted_angles.push_back({a, a + 1, a + 2, 2 * random.uniform() - 1, about(2)});
      if (left >= 2) terms.field_pairs.push_back({a, a + 2, random.uniform() - 0.5, about(5), 0.2});
      if (left >= 1) terms.tabulated_bonds.push_back({a, a + 1, of_bonds[a % 2]});
      if (left >= 2) terms.tabulated_angles.push_back({a, a + 1, a + 2, of_angles[a % 2]});
      if (left < 3) continue;
      terms.bending_torsions.push_back(
          {a, a + 1, a + 2, a + 3, {about(9), about(-4), about(5), about(-3), about(6)}});
      for (int n = 1; n <= 1 + a % 6; ++n)
        terms.torsions.push_back({a, a + 1, a + 2, a + 3, n, about(1), about(5)});
      terms.rb_torsions.push_back(
          {a, a + 1, a + 2, a + 3, {about(9), about(12), about(-13), about(-3), about(26), about(-31)}});
      terms.harmonic_torsions.push_back({a, a + 1, a + 2, a + 3, pi * (2 * random.uniform() - 1), about(40)});
      if (left >= 4) terms.cmaps.push_back({{a, a + 1, a + 2, a + 3}, {a + 1, a + 2, a + 3, a + 4}, a % 2});
      exceptions.push_back({a, a + 3, random.uniform() - 0.5, about(0.1), about(0.5)});
    }
  }
};

struct Sum {
  double energy;
  Vectors f;
};

void expect_equal(const Sum& lanes, const Sum& plain) {
  EXPECT_NEAR(lanes.energy, plain.energy, 1e-12 * std::abs(plain.energy));
  EXPECT_LT((lanes.f - plain.f).norm(), 1e-12 * plain.f.norm());
}

// Added to forces that are there already.
template <class Term, class Add>
Sum sum(const std::vector<Term>& terms, const Vectors& x, const Add& add) {
  Sum s{0, Vectors::Constant(3, x.cols(), 1)};
  s.energy = add(terms, x, s.f);
  return s;
}

const auto kInLanes = [](const auto& terms, const Vectors& x, Vectors& f) {
  return add_term_forces(terms, x, f);
};

// All counts up to a few vectors and blocks, so that lanes are left over in every way.
template <class Term, class Add>
void expect_lanes_as_plain(std::vector<Term> terms, const Vectors& x, const Add& plain) {
  while (!terms.empty()) {
    if constexpr (std::is_same_v<Term, PeriodicTorsion> || std::is_same_v<Term, HarmonicTorsion>) {
      using Prepared =
          std::conditional_t<std::is_same_v<Term, PeriodicTorsion>, ExpandedTorsion, TurnedTorsion>;
      const std::vector<Prepared> prepared(terms.begin(), terms.end());
      expect_equal(sum(prepared, x, kInLanes), sum(terms, x, plain));
    } else {
      expect_equal(sum(terms, x, kInLanes), sum(terms, x, plain));
    }
    terms.pop_back();
  }
}

TEST(BondedLanes, AddWhatThePlainLoopsAddOnEveryKindOfMachine) {
  const Chains c(10, 9);
  on_every_machine([&] {
    expect_lanes_as_plain(c.terms.bonds, c.x, add_bonds);
    expect_lanes_as_plain(c.terms.angles, c.x, add_angles);
    expect_lanes_as_plain(c.terms.cosine_angles, c.x, add_cosine_angles);
    expect_lanes_as_plain(c.terms.cosine_squared_angles, c.x, add_cosine_squared_angles);
    expect_lanes_as_plain(c.terms.restricted_angles, c.x, add_restricted_angles);
    expect_lanes_as_plain(c.terms.field_pairs, c.x, add_field_pairs);
    expect_lanes_as_plain(c.terms.bending_torsions, c.x, add_bending_torsions);
    expect_lanes_as_plain(c.terms.tabulated_bonds, c.x, add_tabulated_bonds);
    expect_lanes_as_plain(c.terms.tabulated_angles, c.x, add_tabulated_angles);
    expect_lanes_as_plain(c.terms.torsions, c.x, add_torsions);
    expect_lanes_as_plain(c.terms.rb_torsions, c.x, add_rb_torsions);
    expect_lanes_as_plain(c.terms.harmonic_torsions, c.x, add_harmonic_torsions);
    expect_lanes_as_plain(c.terms.fene, c.x, add_fene);
    expect_lanes_as_plain(c.exceptions, c.x, add_exceptions);
  });
}

TEST(BondedLanes, AnglesFromFoldedToStraight) {
  std::vector<HarmonicAngle> angles;
  std::vector<double> at = {0, 1e-7, 1e-3, pi / 4, pi / 2 - 1e-9, pi / 2, pi / 2 + 1e-9, 2, pi - 1e-3, pi};
  Vectors x(3, 3 * at.size());
  for (int n = 0; n < static_cast<int>(at.size()); ++n) {
    x.col(3 * n) = Vec3(0.1, 0, 0);
    x.col(3 * n + 1).setZero();
    x.col(3 * n + 2) = 0.2 * Vec3(std::cos(at[n]), std::sin(at[n]), 0);
    angles.push_back({3 * n, 3 * n + 1, 3 * n + 2, 1.1, 400});
  }
  on_every_machine([&] { expect_lanes_as_plain(angles, x, add_angles); });
}

TEST(BondedLanes, TorsionsWithAnEndOnTheAxisHaveNoForces) {
  Vectors x(3, 4);
  x << 0, 0.1, 0.2, 0.25,  //
      0, 0, 0, 0.1,        //
      0, 0, 0, 0;
  const std::vector<RyckaertBellemans> rb = {{0, 1, 2, 3, {1, 2, 3, 4, 5, 6}}};
  const std::vector<ExpandedTorsion> periodic = {ExpandedTorsion({3, 2, 1, 0, 3, 0, 7})};
  on_every_machine([&] {
    const Sum s = sum(rb, x, kInLanes);
    EXPECT_EQ(s.energy, 1 - 2 + 3 - 4 + 5 - 6);  // at φ = 0
    EXPECT_EQ(s.f, Vectors::Constant(3, 4, 1));
    EXPECT_EQ(sum(periodic, x, kInLanes).energy, 14);
  });
}

// Four atoms in line, in any direction and as rounding leaves it, stretched out or folded back at either end:
// angles of π and 0, torsions without a φ. Nothing is undefined, and no force is larger than a moment over an
// arm.
TEST(BondedLanes, AtomsInLineGiveFiniteForces) {
  Random random(3);
  for (int turn = 0; turn < 200; ++turn) {
    const Vec3 line = random.unit_vector(), origin = 10 * random.normal_vector();
    const double first = turn % 2 == 0 ? -0.1 : 0.17, last = turn % 3 == 0 ? 0.3 : 0.02;
    Vectors x(3, 4);
    x << origin + first * line, origin, origin + 0.13 * line, origin + last * line;
    const std::vector<HarmonicAngle> angles = {{0, 1, 2, 1.9, 400}, {1, 2, 3, 1.9, 400}};
    const std::vector<PeriodicTorsion> torsions = {{0, 1, 2, 3, 3, 0.5, 7}};
    const std::vector<ExpandedTorsion> expanded = {ExpandedTorsion(torsions[0])};
    const std::vector<RyckaertBellemans> rb = {{0, 1, 2, 3, {1, 2, 3, 4, 5, 6}}};
    const std::vector<HarmonicTorsion> harmonic = {{0, 1, 2, 3, 0.5, 7}};
    on_every_machine([&] {
      expect_lanes_as_plain(harmonic, x, add_harmonic_torsions);
      const Sum bends = sum(angles, x, kInLanes);
      EXPECT_NEAR(bends.energy, sum(angles, x, add_angles).energy, 1e-9 * bends.energy);
      EXPECT_LT(bends.f.cwiseAbs().maxCoeff(), 4 * 400 * pi / 0.1);  // not for NaN
      expect_equal(sum(expanded, x, kInLanes), sum(torsions, x, add_torsions));
      expect_equal(sum(rb, x, kInLanes), sum(rb, x, add_rb_torsions));
      EXPECT_EQ(sum(rb, x, kInLanes).f, Vectors::Constant(3, 4, 1));
    });
  }
}

// Where there is no direction there is no force.
TEST(BondedLanes, AtomsInOnePlaceGiveFiniteForces) {
  const Vectors x = Vectors::Constant(3, 3, 0.7);
  const std::vector<HarmonicBond> bonds = {{0, 1, 0.1, 3000}};
  const std::vector<HarmonicAngle> angles = {{0, 1, 2, 1.9, 400}};
  on_every_machine([&] {
    expect_lanes_as_plain(bonds, x, add_bonds);
    expect_lanes_as_plain(angles, x, add_angles);
    EXPECT_NEAR(sum(bonds, x, kInLanes).energy, 0.5 * 3000 * 0.01, 1e-12);
    EXPECT_EQ(sum(bonds, x, kInLanes).f, Vectors::Constant(3, 3, 1));
    EXPECT_EQ(sum(angles, x, kInLanes).f, Vectors::Constant(3, 3, 1));
  });
}

TEST(BondedLanes, LetANanShow) {
  Chains c(1, 6);
  c.x(1, 2) = std::nan("");
  const auto expect_shown = [&](const auto& terms) {
    on_every_machine([&] {
      const Sum s = sum(terms, c.x, kInLanes);
      EXPECT_TRUE(std::isnan(s.energy));
      EXPECT_TRUE(s.f.col(2).hasNaN());
    });
  };
  expect_shown(c.terms.bonds);
  expect_shown(c.terms.angles);
  expect_shown(c.terms.cosine_squared_angles);
  expect_shown(std::vector{ExpandedTorsion(c.terms.torsions[0])});
  expect_shown(c.terms.rb_torsions);
  expect_shown(std::vector{TurnedTorsion(c.terms.harmonic_torsions[0])});
  expect_shown(c.terms.fene);
  expect_shown(std::vector<PairException>{{1, 2, 0.1, 0.1, 0.1}});
}

// Of three atoms, the first turn in line, the others anywhere.
void expect_slopes(const auto& angles, bool in_line) {
  Random random(5);
  for (int turn = in_line ? 0 : 1; turn < 5; ++turn) {
    Vectors x(3, 3);
    for (int a = 0; a < 3; ++a) x.col(a) = turn == 0 ? Vec3(0.1 * a, 0, 0) : Vec3(random.normal_vector());
    const Sum here = sum(angles, x, kInLanes);
    for (int a = 0; a < 3; ++a)
      for (int d = 0; d < 3; ++d) {
        const double by = 1e-6;
        Vectors up = x, down = x;
        up(d, a) += by, down(d, a) -= by;
        const double slope =
            (sum(angles, up, kInLanes).energy - sum(angles, down, kInLanes).energy) / (2 * by);
        // sum() adds to forces of 1
        EXPECT_NEAR(here.f(d, a) - 1, -slope, 2e-8 * (1 + std::abs(slope)));
      }
  }
}

// Also where the atoms are in line, where the energy of a cosine is smooth.
TEST(BondedLanes, CosineAnglesPushDownTheirEnergysSlope) {
  expect_slopes(std::vector<CosineAngle>{{0, 1, 2, 7}}, true);
  expect_slopes(std::vector<CosineSquaredAngle>{{0, 1, 2, -0.3, 7}}, true);
  Vectors straight(3, 3);
  straight << 0, 0.1, 0.2, 0, 0, 0, 0, 0, 0;
  EXPECT_NEAR(sum(std::vector<CosineAngle>{{0, 1, 2, 7}}, straight, kInLanes).energy, 0, 1e-14);
  EXPECT_NEAR(sum(std::vector<CosineSquaredAngle>{{0, 1, 2, -0.3, 7}}, straight, kInLanes).energy, 3.5 * 0.49,
              1e-14);
}

TEST(BondedLanes, RestrictedAnglesPushDownTheirEnergysSlope) {
  expect_slopes(std::vector<RestrictedAngle>{{0, 1, 2, -0.3, 0.1}}, false);
}

TEST(BondedLanes, BendingTorsionsFadeWhereThreeAtomsAreInLine) {
  Vectors x(3, 4);
  x << 0, 0.1, 0.2, 0.2, 0, 0, 0, 0.1, 0, 0, 0, 0;
  const std::vector<BendingTorsion> terms = {{0, 1, 2, 3, {3, -4, 5, 2, 1}}};
  EXPECT_EQ(sum(terms, x, kInLanes).energy, 0);
  EXPECT_EQ(sum(terms, x, kInLanes).f, Vectors::Constant(3, 4, 1));
  x.col(0) = Vec3(0.1, 0.1, 0);  // square and cis
  EXPECT_NEAR(sum(terms, x, kInLanes).energy, 7, 1e-13);
}

TEST(Tables, PushDownTheirEnergysSlope) {
  const Chains c(1, 3);
  const auto of_distance =
      std::make_shared<const Spline>("", 0, 9, c.terms.tabulated_bonds[1].energy->values());
  expect_slopes(std::vector<TabulatedBond>{{0, 1, of_distance}, {2, 1, of_distance}}, true);
  expect_slopes(c.terms.tabulated_angles, false);
}

Sum plain_sum(const Chains& c) {
  Sum s{0, Vectors::Zero(3, c.x.cols())};
  s.energy = add_bonds(c.terms.bonds, c.x, s.f) + add_angles(c.terms.angles, c.x, s.f) +
             add_cosine_angles(c.terms.cosine_angles, c.x, s.f) + add_torsions(c.terms.torsions, c.x, s.f) +
             add_rb_torsions(c.terms.rb_torsions, c.x, s.f) +
             add_harmonic_torsions(c.terms.harmonic_torsions, c.x, s.f) +
             add_term_forces(cmap_pairs(c.terms.maps, c.terms.cmaps), c.x, s.f) +
             add_cosine_squared_angles(c.terms.cosine_squared_angles, c.x, s.f) +
             add_restricted_angles(c.terms.restricted_angles, c.x, s.f) +
             add_field_pairs(c.terms.field_pairs, c.x, s.f) +
             add_bending_torsions(c.terms.bending_torsions, c.x, s.f) +
             add_tabulated_bonds(c.terms.tabulated_bonds, c.x, s.f) +
             add_tabulated_angles(c.terms.tabulated_angles, c.x, s.f) + add_fene(c.terms.fene, c.x, s.f) +
             add_exceptions(c.exceptions, c.x, s.f);
  return s;
}

Sum sum_by_threads(BondedForces forces, const Vectors& x, int threads) {
  use_threads(threads);
  Sum s{0, Vectors::Zero(3, x.cols())};
  for (const double energy : forces.add_forces(x, s.f)) s.energy += energy;
  use_threads(1);
  return s;
}

void expect_the_same_on_any_number_of_threads(const BondedForces& forces, const Chains& c) {
  const Sum one = sum_by_threads(forces, c.x, 1);
  expect_equal(one, plain_sum(c));
  for (int threads : {2, 3, 7}) {
    const Sum more = sum_by_threads(forces, c.x, threads);
    EXPECT_EQ(more.energy, one.energy);
    EXPECT_EQ(more.f, one.f);
  }
}

TEST(BondedForces, AreTheSameBitsOnAnyNumberOfThreads) {
  const Chains c(200, 9);
  const BondedForces forces(c.terms, c.exceptions);
  EXPECT_GT(forces.pieces().count(), 8);
  EXPECT_EQ(forces.pieces().phases().size(), 1u) << "molecules stay whole";
  on_every_machine([&] { expect_the_same_on_any_number_of_threads(forces, c); });
}

TEST(BondedForces, OfOneLargeMoleculeAreSharedOutAmongThreads) {
  const Chains c(1, 1000);
  const BondedForces forces(c.terms, c.exceptions);
  ASSERT_EQ(forces.pieces().phases().size(), 2u);
  for (const Pieces::Phase& phase : forces.pieces().phases())
    EXPECT_GT(phase.terms, 7 * 768) << "enough for seven threads";
  expect_the_same_on_any_number_of_threads(forces, c);
}

// Sorts bonds, cuts them into pieces of some fifty and looks at each. Returns the number of pieces.
int expect_pieces_apart(std::vector<HarmonicBond> bonds, std::size_t phases) {
  std::ranges::stable_sort(bonds, kByLowestAtom);
  const Pieces pieces({bonds.begin(), bonds.end()}, 50);
  const std::vector<int> start = pieces.starts_of(bonds);
  EXPECT_EQ(pieces.phases().size(), phases);
  std::size_t seen = 0;
  for (const Pieces::Phase& phase : pieces.phases()) {
    std::map<int, int> piece_of;
    for (const int piece : phase.pieces)
      for (int k = start[piece]; k < start[piece + 1]; ++k, ++seen)
        for (const int atom : atoms_of(bonds[k]))
          EXPECT_EQ(piece_of.emplace(atom, piece).first->second, piece) << "atom " << atom;
  }
  EXPECT_EQ(seen, bonds.size());
  return pieces.count();
}

TEST(Pieces, OfAPhaseShareNoAtomWhateverTheBonds) {
  std::vector<HarmonicBond> chain, molecules, star, hydrogens_last;
  for (int a = 0; a < 1000; ++a) chain.push_back({a, a + 1, 0, 0});
  EXPECT_EQ(expect_pieces_apart(chain, 2), 20);
  chain.push_back({700, 20, 0, 0});
  chain.push_back({990, 30, 0, 0});
  expect_pieces_apart(chain, 3);

  for (int a = 0; a < 1000; ++a)
    if (a % 10 != 9) molecules.push_back({a, a + 1, 0, 0});
  EXPECT_EQ(expect_pieces_apart(molecules, 1), 17) << "of 54 bonds: six molecules";

  for (int a = 1; a <= 1000; ++a) star.push_back({0, a, 0, 0});
  EXPECT_EQ(expect_pieces_apart(star, 1), 1) << "terms of the same lowest atom stay together";
  star.clear();
  for (int a = 0; a < 5000; ++a) star.push_back({a, 5000, 0, 0});
  EXPECT_EQ(expect_pieces_apart(star, 100), 100) << "one after the other";

  for (int a = 0; a < 500; ++a) {
    hydrogens_last.push_back({a, 1000 + a, 0, 0});
    if (a < 499) hydrogens_last.push_back({a, a + 1, 0, 0});
  }
  EXPECT_EQ(expect_pieces_apart(hydrogens_last, 2), 19);
  EXPECT_EQ(expect_pieces_apart({}, 0), 0);
}

TEST(BondedForces, TakeTermsInAnyOrderAndAcrossAllAtoms) {
  Chains c(100, 9);
  std::reverse(c.terms.angles.begin(), c.terms.angles.end());
  std::reverse(c.terms.torsions.begin(), c.terms.torsions.end());
  const BondedForces pieces(c.terms, c.exceptions);
  EXPECT_GT(pieces.pieces().count(), 3);
  expect_equal(sum_by_threads(pieces, c.x, 3), plain_sum(c));
  c.terms.bonds.push_back({899, 0, 0.15, 1});
  const BondedForces forces(c.terms, c.exceptions);
  EXPECT_EQ(forces.pieces().phases().size(), 3u) << "one more for the bond that closes a ring";
  expect_equal(sum_by_threads(forces, c.x, 2), plain_sum(c));
}

TEST(BondedForces, NameTheFeneBondThatBroke) {
  Chains c(200, 9);
  c.terms.fene[1000].r0 = 0.1499;
  c.terms.fene[700].r0 = 0.1;
  BondedForces forces(c.terms, {});
  const auto [i, j, k, r0] = c.terms.fene[700];
  const std::string said = error_message<SimulationFailure>([&] { sum_by_threads(forces, c.x, 2); });
  use_threads(1);
  EXPECT_THAT(said, testing::HasSubstr("bond " + std::to_string(i) + "-" + std::to_string(j) + " broke"));
}

}  // namespace
}  // namespace taut::bonded_tests
