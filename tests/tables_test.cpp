// Energies by tables: the spline and its error, what is refused, and that nothing is extrapolated.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/random.hpp"
#include "base/threads.hpp"
#include "error_message.hpp"
#include "every_machine.hpp"
#include "forcefield/bonded/bonded_forces.hpp"
#include "forcefield/force_field.hpp"
#include "forcefield/pairs/cluster_pairs.hpp"
#include "reference/plain_pairs.hpp"
#include "reference/plain_spline.hpp"

namespace taut::tables_tests {
namespace {

using std::numbers::pi;
using testing::HasSubstr;

std::shared_ptr<const Spline> table_of(const std::function<double(double)>& energy, double first, double last,
                                       int points) {
  std::vector<double> values;
  for (int k = 0; k < points; ++k) values.push_back(energy(first + (last - first) * k / (points - 1)));
  return std::make_shared<const Spline>("a.csv", first, last, values);
}

State state_at(const Vectors& x, const Box& box = {}) {
  return {x, Vectors::Zero(3, x.cols()), Vectors::Zero(3, x.cols()), 0, box};
}

double lennard_jones(double r) {
  return 4 * (std::pow(0.3 / r, 12) - std::pow(0.3 / r, 6));
}
double lennard_jones_slope(double r) {
  return 24 / r * (std::pow(0.3 / r, 6) - 2 * std::pow(0.3 / r, 12));
}

TEST(Spline, IsTheNaturalOneOfItsPoints) {
  for (const int points : {3, 4, 7, 200}) {
    const auto table = table_of(lennard_jones, 0.27, 0.9, points);
    const tests::PlainSpline plain(*table);
    for (double r = 0.27; r <= 0.9; r += 0.00317) {
      EXPECT_NEAR(table->at(r).value, plain.value(r), 1e-12 * (1 + std::abs(plain.value(r))));
      EXPECT_NEAR(table->at(r).slope, plain.slope(r), 1e-10 * (1 + std::abs(plain.slope(r))));
    }
    EXPECT_NEAR(table->at(0.9).value, lennard_jones(0.9), 1e-13);
  }
}

// Away from the ends an energy is right to h⁴ and a force to h³: half the spacing makes a 16th and an 8th of the error.
TEST(Spline, IsRightToTheFourthOrderAndItsSlopeToTheThird) {
  struct Error {
    double energy = 0, slope = 0;
  };
  const auto error = [](int points) {
    const auto table = table_of(lennard_jones, 0.27, 0.9, points);
    Error most;
    for (double r = 0.33; r < 0.8; r += 0.00005) {
      most.energy = std::max(most.energy, std::abs(table->at(r).value - lennard_jones(r)));
      most.slope = std::max(most.slope, std::abs(table->at(r).slope - lennard_jones_slope(r)));
    }
    return most;
  };
  for (const int points : {201, 401, 801}) {
    const Error wide = error(points), narrow = error(2 * points - 1);
    EXPECT_NEAR(wide.energy / narrow.energy, 16, 1.5) << points;
    EXPECT_NEAR(wide.slope / narrow.slope, 8, 0.8) << points;
  }
  EXPECT_LT(error(201).energy, 2e-5);
}

// Three atoms, whose bonds and angle are harmonic by formula and by tables.
TEST(Tables, OfHarmonicEnergiesAreHarmonic) {
  Vectors x(3, 3);
  x << 0, 0.16, 0.21, 0, 0.01, 0.13, 0, 0, 0.02;
  Terms formula, tables;
  formula.bonds = {{0, 1, 0.15, 3000}, {1, 2, 0.15, 3000}};
  formula.angles = {{0, 1, 2, 2, 300}};
  const auto stretch = table_of([](double r) { return 1500 * std::pow(r - 0.15, 2); }, 0.1, 0.2, 101);
  const auto bend = table_of([](double a) { return 150 * std::pow(a - 2, 2); }, 0, pi, 181);
  tables.tabulated_bonds = {{0, 1, stretch}, {1, 2, stretch}};
  tables.tabulated_angles = {{0, 1, 2, bend}};
  const System sys = make_system(Eigen::VectorXd::Ones(3), {});
  State by_formula = state_at(x), by_tables = by_formula;
  ForceField one(sys, {}, formula), two(sys, {}, tables);
  EXPECT_NEAR(one.evaluate_energy(sys, by_formula), two.evaluate_energy(sys, by_tables), 1e-9);
  EXPECT_LT((by_formula.f - by_tables.f).norm(), 1e-8 * by_formula.f.norm());
  ForceField::Evaluation evaluation;
  two.evaluate(sys, by_tables, evaluation);
  const Energies names = two.energies(by_tables, evaluation);
  ASSERT_EQ(names.size(), 2u);
  EXPECT_EQ(names[0].first, "tabulated_bond");
  EXPECT_EQ(names[1].first, "tabulated_angle");
  const auto virial = [&](ForceField& forces, State& s) {
    forces.evaluate(sys, s, evaluation);
    return forces.virial(s, evaluation);
  };
  EXPECT_LT((virial(one, by_formula) - virial(two, by_tables)).norm(), 1e-8 * by_formula.f.norm());
}

std::string said(const auto& act) {
  return error_message<std::runtime_error>([&] { act(); });
}

TEST(Tables, EndWhereTheyEnd) {
  Terms terms;
  terms.tabulated_bonds = {{1, 0, table_of(lennard_jones, 0.3, 0.5, 9)}};
  terms.tabulated_angles = {{0, 1, 2, table_of(lennard_jones, 0.5, pi / 2, 9)}};
  BondedForces forces(terms, {});
  const System three = make_system(Eigen::VectorXd::Ones(3), {});
  const auto at = [&](double r, double theta) {
    Vectors x(3, 3);
    x << r, 0, std::cos(theta), 0, 0, std::sin(theta), 0, 0, 0;
    Vectors f = Vectors::Zero(3, 3);
    const std::string in_run = said([&] { forces.add_forces(x, f); });
    const std::string at_start = said([&] { check_tables_cover(three, terms, x); });
    EXPECT_EQ(in_run == "no error", at_start == "no error");
    return in_run;
  };
  EXPECT_EQ(at(0.4, 1), "no error");
  EXPECT_EQ(at(0.5, pi / 2), "no error");
  EXPECT_EQ(at(0.3, 0.5), "no error");
  EXPECT_EQ(at(0.501, 1),
            "tabulated bond 1-0 is 0.501 nm long, its table a.csv goes from 0.3 to 0.5 nm; take a shorter "
            "step, or a "
            "table that goes further");
  EXPECT_THAT(at(0.299, 1), HasSubstr("tabulated bond 1-0 is 0.299 nm long"));
  EXPECT_THAT(at(0.4, 1.6),
              HasSubstr("tabulated angle 0-1-2 is 91.6732 degrees, its table a.csv goes from 28.6479 to 90"));
  EXPECT_THAT(at(std::nan(""), 1), HasSubstr("tabulated bond 1-0 is nan nm long"));
}

TEST(Tables, ThatAreNoneAreRefused) {
  const auto made = [](double first, double last, std::vector<double> values) {
    return said([&] { Spline("a.csv", first, last, values); });
  };
  EXPECT_EQ(made(0, 1, {1, 2, 3}), "no error");
  EXPECT_EQ(made(0, 1, {1, 2}), "the table a.csv has 2 values, expected 3 or more");
  EXPECT_EQ(made(1, 1, {1, 2, 3}), "the table a.csv goes from 1 to 1");
  EXPECT_EQ(made(0, 1, {1, NAN, 3}), "the table a.csv has a value that is not a finite number");
}

// Three kinds, of which two have tables among themselves and with each other, of other ranges and spacings.
TabulatedPairs some_tables(int atoms) {
  TabulatedPairs pairs;
  for (int a = 0; a < atoms; ++a) pairs.kind.push_back(a % 7 == 0 ? -1 : a % 3);  // kind 2: none
  pairs.potentials = {{0, 0, table_of(lennard_jones, 0.12, 0.9, 301)},
                      {1, 0, table_of([](double r) { return std::cos(9 * r) - std::cos(9.0); }, 0, 1, 77)},
                      {1, 1, table_of([](double r) { return 30 * std::pow(0.6 - r, 2); }, 0.01, 0.6, 3)}};
  for (int a = 3; a < atoms; a += 2) pairs.exclusions.push_back({a, a - 3});
  return pairs;
}

// Beads on a shaken lattice of 0.25 nm, so that no two are nearer than the tables begin.
Vectors shaken_lattice(int edge, double shake) {
  Random random(11);
  Vectors x(3, edge * edge * edge);
  for (int a = 0; a < x.cols(); ++a)
    x.col(a) = 0.25 * Vec3(a % edge, a / edge % edge, a / (edge * edge)) + shake * random.uniform_vector();
  return x;
}

const std::vector<Box> kBoxes = {Box{}, Box{Vec3::Constant(2.5)}, Box{Vec3(2.5, 2.6, 2.7)},
                                 Box{Vec3(2.5, 2.5, 2.5), Vec3(0.4, -0.7, 0.9)}};

TEST(TabulatedPairs, AreThePlainLoopsInEveryBox) {
  Vectors x = shaken_lattice(10, 0.05);
  const TabulatedPairs pairs = some_tables(static_cast<int>(x.cols()));
  for (const Box& box : kBoxes)
    tests::on_every_machine([&] {
      ClusterPairs lists(pairs, box.periodic(), Precision::kDouble);
      ClusterPairs mixed(pairs, box.periodic(), Precision::kMixed);
      Vectors moved = x;
      Random random(2);
      for (int step = 0; step < 4; ++step) {
        const tests::PairSums plain = tests::plain_pairs(pairs, box, moved);
        const auto expect_plain = [&](ClusterPairs& of, double error) {
          Vectors f = Vectors::Zero(3, x.cols());
          of.add_forces(moved, box, f);
          EXPECT_LT((f - plain.f).cwiseAbs().maxCoeff(), error * plain.f.cwiseAbs().maxCoeff());
          EXPECT_NEAR(of.energy(), plain.energy, error * std::abs(plain.energy));
          EXPECT_LT((of.virial() - plain.virial).norm(), error * plain.virial.norm());
        };
        expect_plain(lists, 1e-11);
        expect_plain(mixed, 1e-5);
        for (auto&& column : moved.colwise()) column += 0.01 * random.unit_vector();
      }
    });
}

TEST(TabulatedPairs, StopNearerThanTheyBegin) {
  TabulatedPairs pairs{{0, 0, 0, 0}, {{0, 0, table_of(lennard_jones, 0.25, 0.9, 99)}}, {{0, 1}}};
  Vectors x(3, 4), f = Vectors::Zero(3, 4);
  x << 0, 0.1, 0.5, 0.8, 0, 0, 0, 0, 0, 0, 0, 0;
  ClusterPairs lists(pairs, false, Precision::kDouble);
  EXPECT_EQ(said([&] { lists.add_forces(x, {}, f); }), "no error");  // 0 and 1 are left out
  x(0, 3) = 0.74;
  EXPECT_THAT(
      said([&] { lists.add_forces(x, {}, f); }),
      HasSubstr("are 0.24 nm apart, nearer than their table a.csv begins, at 0.25 nm; take a shorter step"));
  EXPECT_EQ(lists.energy(), HUGE_VAL);
}

// Those of anchors count in no pressure.
TEST(TabulatedPairs, OfAnchorsHaveNoVirial) {
  const System sys = make_system(Eigen::Vector4d(0, 0, 0, 1), {});
  Terms terms;
  terms.tabulated_pairs =
      TabulatedPairs{{0, 0, 0, -1}, {{0, 0, table_of(lennard_jones, 0.2, 0.9, 99)}}, {{0, 1}}};
  State s = state_at(Vectors::Zero(3, 4), Box{Vec3::Constant(3)});
  s.x.row(0) << 0, 0.4, 0.8, 1.2;
  ForceField forces(sys, s.box, terms);
  ForceField::Evaluation evaluation;
  forces.evaluate(sys, s, evaluation);
  EXPECT_GT(s.f.norm(), 0.1);
  EXPECT_LT(forces.virial(s, evaluation).norm(), 1e-12);
}

TEST(TabulatedPairs, ThatAreNoneAreRefused) {
  const System sys = make_system(Eigen::VectorXd::Ones(4), {});
  const auto table = table_of(lennard_jones, 0.25, 0.9, 99);
  const auto made = [&](TabulatedPairs pairs, const Box& box = {}) {
    Terms terms;
    terms.tabulated_pairs = std::move(pairs);
    return said([&] { ForceField(sys, box, terms); });
  };
  EXPECT_EQ(made({{0, 0, 1, -1}, {{0, 1, table}}, {}}), "no error");
  EXPECT_EQ(made({{0, 0, 1}, {{0, 1, table}}, {}}), "tabulated pairs: 3 kinds for 4 atoms");
  EXPECT_EQ(made({{0, 0, 1, 1}, {}, {}}), "tabulated pairs: there is no table");
  EXPECT_EQ(made({{0, 0, 1, 1}, {{0, 1, table}, {1, 0, table}}, {}}),
            "tabulated pairs, table 1: kinds 1 and 0 have one already");
  EXPECT_EQ(made({{0, 0, 1, 1}, {{0, -1, table}}, {}}),
            "tabulated pairs, table 0: kinds 0 and -1, expected 0 to 2047");
  EXPECT_THAT(made({{0, 0, 1, 1}, {{0, 1, table}}, {{0, 4}}}), HasSubstr("atom 4 is out of range"));
  EXPECT_EQ(made({{0, 0, 1, 1}, {{0, 1, table}}, {}}, Box{Vec3::Constant(1.7)}),
            "tabulated pairs: their tables end at 0.9 nm, over half the box's shortest edge, 0.85 nm");
}

}  // namespace
}  // namespace taut::tables_tests
