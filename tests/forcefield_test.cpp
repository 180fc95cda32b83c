#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>

#include "base/errors.hpp"
#include "error_message.hpp"
#include "force_checks.hpp"
#include "forcefield/bonded/cmap.hpp"
#include "forcefield/force_field.hpp"

namespace taut::forcefield_tests {
namespace {

using std::numbers::pi;

const Vectors kBent = columns({{0.1, 0.02, -0.03}, {0.0, 0.15, 0.01}, {0.12, 0.24, 0.05}, {0.1, 0.3, 0.19}});

const Vectors kBentChain =
    columns({{0.1, 0.02, -0.03}, {0.0, 0.15, 0.01}, {0.12, 0.24, 0.05}, {0.1, 0.3, 0.19}, {0.2, 0.41, 0.17}});

// Two dihedrals side by side under a map of 5 x 5 points.
const Terms kCorrected = [] {
  Terms terms{.cmaps = {{{0, 1, 2, 3}, {1, 2, 3, 4}, 0}}};
  terms.maps.emplace_back(Eigen::MatrixXd::NullaryExpr(
      5, 5, [](Eigen::Index i, Eigen::Index j) { return std::sin(3.0 * double(i) + 7.0 * double(j * j)); }));
  return terms;
}();

// ---- bonded: closed forms ----

TEST(Bonds, StretchedBondPullsItsEndsTogether) {
  const auto [energy, f] = evaluate({.bonds = {{0, 1, 0.1, 3000}}}, columns({{0, 0, 0}, {0.12, 0, 0}}));
  EXPECT_NEAR(energy, 0.5 * 3000 * 0.02 * 0.02, 1e-12);
  EXPECT_NEAR(f(0, 0), 60, 1e-10);
  EXPECT_NEAR(f(0, 1), -60, 1e-10);
}

TEST(Angles, NarrowAngleOpens) {
  const double rest = 2.0, k = 400;
  const auto [energy, f] =
      evaluate({.angles = {{0, 1, 2, rest, k}}}, columns({{0.1, 0, 0}, {0, 0, 0}, {0, 0.2, 0}}));
  EXPECT_NEAR(energy, 0.5 * k * std::pow(pi / 2 - rest, 2), 1e-10);
  const double moment = k * (rest - pi / 2);  // opens: atom 0 is driven to −y, atom 2 to −x
  EXPECT_NEAR(f(1, 0), -moment / 0.1, 1e-9);
  EXPECT_NEAR(f(0, 2), -moment / 0.2, 1e-9);
  EXPECT_NEAR(f(0, 0), 0, 1e-9);
}

// Four atoms with dihedral φ in the IUPAC sign: seen along j→k, l is turned clockwise from i by φ.
Vectors dihedral_at(double phi) {
  // the axis along z, towards the viewer's far side; clockwise for a viewer looking to +z is x to y
  return columns({{0.1, 0, -0.02}, {0, 0, 0}, {0, 0, 0.15}, {0.1 * std::cos(phi), 0.1 * std::sin(phi), 0.2}});
}

TEST(Torsions, FollowTheirCosineInTheIupacSign) {
  const double k = 7, phase = 0.4;
  for (int n : {1, 2, 3})
    for (double phi : {-3.0, -1.2, 0.0, 0.3, 1.0, 2.5, pi}) {
      const auto [energy, f] = evaluate({.torsions = {{0, 1, 2, 3, n, phase, k}}}, dihedral_at(phi));
      EXPECT_NEAR(energy, k * (1 + std::cos(n * phi - phase)), 1e-12);
      const double torque = k * n * std::sin(n * phi - phase);  // −dE/dφ, about z at distance 0.1
      EXPECT_NEAR(f(0, 3), -std::sin(phi) * torque / 0.1, 1e-10);
      EXPECT_NEAR(f(1, 3), std::cos(phi) * torque / 0.1, 1e-10);
      EXPECT_NEAR(f(1, 0), -torque / 0.1, 1e-10);
    }
}

TEST(RbTorsions, ArePolynomialsInTheCosineFromTrans) {
  const std::array<double, 6> c = {9.28, 12.16, -13.12, -3.06, 26.24, -31.5};
  for (double phi : {-2.0, 0.0, 0.7, pi / 2, 2.9, pi}) {
    double expected = 0;
    for (int n = 0; n < 6; ++n) expected += c[n] * std::pow(std::cos(phi - pi), n);
    EXPECT_NEAR(evaluate({.rb_torsions = {{0, 1, 2, 3, c}}}, dihedral_at(phi)).energy, expected, 1e-12);
  }
}

// Round the circle, the shorter way: at its rest, either side of ±π, and about the far side.
TEST(HarmonicTorsions, TakeTheShorterWay) {
  for (const double rest : {0.0, 0.4, 3.0, pi, -pi, -2.5})
    for (const double turn : {0.0, 1e-9, -1e-9, 0.3, -0.3, 2.0, -2.0, 3.1, -3.1}) {
      const auto [energy, f] =
          evaluate({.harmonic_torsions = {{0, 1, 2, 3, rest, 40}}}, dihedral_at(rest + turn));
      EXPECT_NEAR(energy, 20 * turn * turn, 1e-12 + 1e-13 * energy) << rest << " " << turn;
    }
}

// E = sin φ + cos 2ψ + sin(φ + ψ), whose splines through 48 points are right to 1e-5 or so; and exactly at
// points that are given.
TEST(Cmaps, GoThroughTheirPointsAndAreSmoothBetween) {
  const auto energy = [](double phi, double psi) {
    return std::sin(phi) + std::cos(2 * psi) + std::sin(phi + psi);
  };
  const int n = 48;
  Eigen::MatrixXd points(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) points(i, j) = energy(2 * pi * i / n, 2 * pi * j / n);
  const CmapSurface surface(points);
  for (const double phi : {-3.1, -1.0, 0.0, 0.3, 2.2, pi})
    for (const double psi : {-2.7, -0.4, 0.0, 1.7, 3.0, -pi}) {
      const auto at = surface.at(phi, psi);
      EXPECT_NEAR(at.energy, energy(phi, psi), 2e-5);
      EXPECT_NEAR(at.of_phi, std::cos(phi) + std::cos(phi + psi), 3e-4);
      EXPECT_NEAR(at.of_psi, -2 * std::sin(2 * psi) + std::cos(phi + psi), 3e-4);
    }
  for (int i = -3; i < n; i += 5)
    for (int j = -3; j < n; j += 7)
      EXPECT_NEAR(surface.at(2 * pi * i / n, 2 * pi * j / n).energy, points((i + n) % n, (j + n) % n), 1e-12);
}

TEST(FeneBonds, PullHarderTowardsTheirReachAndBreakThere) {
  const double k = 30, r0 = 1.5, r = r0 / std::sqrt(2);
  const Terms terms{.fene = {{0, 1, k, r0}}};
  const auto [energy, f] = evaluate(terms, columns({{0, 0, 0}, {0, r, 0}}));
  EXPECT_NEAR(energy, 0.5 * k * r0 * r0 * std::log(2), 1e-12);
  EXPECT_NEAR(f(1, 0), 2 * k * r, 1e-11);
  EXPECT_NEAR(f(1, 1), -2 * k * r, 1e-11);
  EXPECT_THROW(evaluate(terms, columns({{0, 0, 0}, {0, r0, 0}})), SimulationFailure);
}

TEST(Bonded, ForcesAreMinusTheSlope) {
  expect_forces_are_minus_the_slope({.bonds = {{0, 1, 0.15, 3000}, {1, 3, 0.2, 5000}}}, kBent);
  expect_forces_are_minus_the_slope({.angles = {{0, 1, 2, 1.9, 400}, {1, 2, 3, 2.0, 300}}}, kBent);
  for (int n : {1, 2, 3, 6})
    expect_forces_are_minus_the_slope({.torsions = {{0, 1, 2, 3, n, 0.5, 7}}}, kBent);
  expect_forces_are_minus_the_slope({.rb_torsions = {{0, 1, 2, 3, {9.3, 12.2, -13.1, -3.1, 26.2, -31.5}}}},
                                    kBent);
  expect_forces_are_minus_the_slope({.harmonic_torsions = {{0, 1, 2, 3, 2.9, 40}}}, kBent);
  expect_forces_are_minus_the_slope(kCorrected, kBentChain);
  expect_forces_are_minus_the_slope({.fene = {{0, 1, 30, 0.2}, {2, 3, 30, 0.3}}}, kBent);
}

// ---- fields ----

TEST(Fields, GravityAndPullsAreUniform) {
  Eigen::VectorXd mass(2);
  mass << 3, 0;  // the second is an anchor
  const System sys = make_system(mass, {});
  ForceField forces(sys, {}, {.gravity = Vec3(0, 0, -9.81), .pulls = {{1, {1, 2, 3}}, {0, {0, 5, 0}}}});
  State s{columns({{0, 1, 2}, {4, 5, 6}}), Vectors::Zero(3, 2), {}, 0, {}};
  ForceField::Evaluation evaluation;
  forces.evaluate(sys, s, evaluation);
  EXPECT_NEAR((s.f - columns({{0, 5, -29.43}, {1, 2, 3}})).norm(), 0, 1e-14);
  const auto energies = forces.energies(s, evaluation);
  ASSERT_EQ(energies.size(), 2u);
  EXPECT_EQ(energies[0].first, "gravity");
  EXPECT_NEAR(energies[0].second, 3 * 9.81 * 2, 1e-12);
  EXPECT_EQ(energies[1].first, "pull");
  EXPECT_NEAR(energies[1].second, -(4 + 10 + 18) - 5, 1e-12);
  EXPECT_EQ(forces.potential(s, evaluation), energies[0].second + energies[1].second);
}

// Half a box and more away it is the other image that is held.
TEST(Fields, RestraintsTakeTheNearestImage) {
  const Terms terms{.restraints = {{0, {0.1, 0.2, 0.3}, 100}, {1, {0.1, 0, 1.9}, 50}}};
  const Vectors x = columns({{0.2, 0.2, 0.3}, {2.0, 4, 0.1}});
  const Evaluated open = evaluate(terms, x), boxed = Bench(2, terms, Box{Vec3(2, 2, 2)}).at(x);
  EXPECT_NEAR((open.f - columns({{-10, 0, 0}, {-95, -200, 90}})).norm(), 0, 1e-12);
  EXPECT_NEAR(open.energy, 0.5 + 25 * (1.9 * 1.9 + 16 + 1.8 * 1.8), 1e-12);
  EXPECT_NEAR((boxed.f - columns({{-10, 0, 0}, {5, 0, -10}})).norm(), 0, 1e-12);
  EXPECT_NEAR(boxed.energy, 0.5 + 25 * (0.01 + 0.04), 1e-12);
}

// What hangs on the box is made anew: lists, PME's waves, the background, the dispersion correction.
TEST(ForceField, FollowsABoxThatChangesAndStopsWhereItIsTooSmall) {
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(4);
  Terms terms{.nonbonded = Nonbonded{ones, 0.1 * ones, ones, {}, 0.9, {}, 78.3, {}, true}};
  terms.nonbonded->pme = PmeParameters{.alpha = 3};
  terms.nonbonded->pme->grid = {20, 22, 24};
  const Box before{Vec3(2, 2, 2)}, after{Vec3(2.1, 1.9, 2.2), Vec3(0.3, -0.4, 0.5)};
  Bench bench(4, terms, before);
  bench.at(kBent);
  bench.box = after;
  const Evaluated changed = bench.at(kBent), made = Bench(4, terms, after).at(kBent);
  EXPECT_NEAR(changed.energy, made.energy, 1e-12 * std::abs(made.energy));
  EXPECT_LT((changed.f - made.f).norm(), 1e-12 * made.f.norm());
  bench.box = before.scaled(Vec3(1, 0.89, 1));
  EXPECT_EQ(error_message<SimulationFailure>([&] { bench.at(kBent); }),
            "the box has shrunk: nonbonded: cutoff 0.9 nm is over half the box's shortest edge, 0.89 nm; "
            "take a larger system or a shorter cutoff");
}

// Pairs set forces that were not cleared only where they act on every atom, and nothing acts before them.
TEST(ForceField, TakesNothingFromForcesThatWere) {
  Eigen::VectorXd numbers(4);
  numbers << 1, 1, 1, 0;
  Terms pairs{.nonbonded = Nonbonded{numbers, 0.1 * numbers, numbers, {}, {}, {}, 78.3, {}, false}};
  const Vectors f = evaluate(pairs, kBent).f;
  EXPECT_EQ(f.col(3), Vec3::Zero());
  EXPECT_GT(f.leftCols(3).colwise().norm().minCoeff(), 0);
  pairs.nonbonded->charge[3] = 1;
  const Vectors on_all = evaluate(pairs, kBent).f;
  pairs.gravity = Vec3(0, 0, -10);
  const Vectors gravity = evaluate(pairs, kBent).f - on_all;
  EXPECT_LT((gravity.colwise() - Vec3(0, 0, -20)).norm(), 1e-12 * on_all.norm());
}

TEST(ForceField, NamesOnlyTheTermsThereAre) {
  EXPECT_TRUE(Bench(3, {}).energies_at(Vectors::Zero(3, 3)).empty());
  Terms all{.bonds = {{0, 1, 0.1, 3000}},
            .angles = {{0, 1, 2, 1.9, 400}},
            .torsions = {{0, 1, 2, 3, 1, 0, 7}},
            .rb_torsions = {{0, 1, 2, 3, {1, 2, 3, 4, 5, 6}}},
            .fene = {{0, 1, 30, 1}},
            .wca = Wca{0.1, 1, {}},
            .gravity = Vec3(1, 0, 0),
            .pulls = {{0, {1, 2, 3}}},
            .restraints = {{2, {0, 0, 1}, 5}}};
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(4);
  all.nonbonded = Nonbonded{ones, 0.1 * ones, ones, {}, 0.9, {}, 78.3, {}, true};
  Bench bench(4, all, Box{Vec3(2, 2, 2)});
  const double potential = bench.at(kBent).energy;
  std::vector<std::string> names;
  double sum = 0;
  for (const auto& [name, energy] : bench.energies_at(kBent)) {
    names.push_back(name);
    sum += energy;
  }
  EXPECT_EQ(names, (std::vector<std::string>{"bond", "angle", "torsion", "rb_torsion", "fene", "lj_coulomb",
                                             "dispersion", "wca", "gravity", "pull", "restraint"}));
  EXPECT_EQ(sum, potential);
}

// ---- input ----

TEST(ForceField, RefusesTermsThatDoNotFit) {
  const auto message = [](const std::function<void(Terms&)>& spoil, const Vec3& edge) {
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(4);
    Terms terms{.nonbonded = Nonbonded{ones, ones, ones, {}, 0.9, {}, 78.3, {}, false},
                .wca = Wca{0.3, 1, {}}};
    spoil(terms);
    return error_message([&] { Bench(4, terms, Box{edge}); });
  };
  const double nan = std::nan("");
  const auto no_cutoff = [](Terms& t) { t.nonbonded->cutoff.reset(); };
  const auto map_of = [](int size, const CmapTorsion& torsion) {
    return [=](Terms& t) { t.maps = {Eigen::MatrixXd::Zero(size, 3)}, t.cmaps = {torsion}; };
  };
  struct Spoiled {
    std::function<void(Terms&)> spoil;
    const char* words;
    Vec3 edge = Vec3::Zero();
  };
  const Spoiled all[] = {
      {[](Terms&) {}, "no error"},
      {[](Terms&) {}, "no error", {1.8, 1.8, 1.8}},
      {[](Terms& t) {
         t.bonds = {{0, 1, 0.1, 1}, {2, 4, 0.1, 1}};
       },
       "bond 1: atom 4 is out of range"},
      {[](Terms& t) {
         t.bonds = {{1, 1, 0.1, 1}};
       },
       "bond 0: atom 1 is in it twice"},
      {[&](Terms& t) {
         t.bonds = {{0, 1, 0.1, nan}};
       },
       "bond 0"},
      {[](Terms& t) {
         t.angles = {{0, 1, 0, 1, 1}};
       },
       "angle 0: atom 0"},
      {[](Terms& t) {
         t.torsions = {{0, 1, 2, -1, 1, 0, 1}};
       },
       "torsion 0: atom -1"},
      {[](Terms& t) {
         t.torsions = {{0, 1, 2, 3, 0, 0, 1}};
       },
       "torsion 0: periodicity 0"},
      {[](Terms& t) {
         t.torsions = {{0, 1, 2, 3, 65, 0, 1}};
       },
       "periodicity 65, expected 1 to 64"},
      {[](Terms& t) {
         t.torsions = {{0, 1, 2, 3, 64, 0, 1}};
       },
       "no error"},
      {[&](Terms& t) {
         t.harmonic_torsions = {{0, 1, 2, 3, nan, 1}};
       },
       "harmonic_torsion 0"},
      {map_of(3, {{0, 1, 2, 3}, {1, 2, 3, 0}, 0}), "no error"},
      {map_of(2, {{0, 1, 2, 3}, {1, 2, 3, 0}, 0}), "map 0: 2 x 3 points"},
      {map_of(3, {{0, 1, 2, 3}, {1, 2, 3, 0}, 1}), "cmap 0: map 1, there are 1"},
      {map_of(3, {{0, 1, 2, 3}, {1, 2, 1, 0}, 0}), "cmap 0: atom 1 is in it twice"},
      {[](Terms& t) {
         t.rb_torsions = {{0, 1, 2, 7, {}}};
       },
       "rb_torsion 0: atom 7"},
      {[](Terms& t) {
         t.fene = {{0, 1, 30, 0}};
       },
       "fene 0: r0"},
      {[](Terms& t) {
         t.pulls = {{4, Vec3::Zero()}};
       },
       "pull 0: atom 4"},
      {[&](Terms& t) {
         t.restraints = {{1, Vec3::Zero(), nan}};
       },
       "restraint 0: nan"},
      {[&](Terms& t) { t.gravity = Vec3(0, nan, 0); }, "gravity"},
      {[](Terms& t) { t.nonbonded->sigma.resize(3); }, "3 values of sigma for 4 atoms"},
      {[](Terms& t) { t.nonbonded->charge.setZero(5); }, "5 values of charge for 4 atoms"},
      {[](Terms& t) { t.nonbonded->epsilon[2] = -1; }, "nonbonded atom 2: epsilon"},
      {[](Terms& t) {
         t.nonbonded->exceptions = {{0, 9, 0, 0, 0}};
       },
       "exception 0: atom 9"},
      {[](Terms& t) {
         t.nonbonded->exceptions = {{0, 1, 0, 0, 0}, {1, 0, 0, 0, 0}};
       },
       "exception 1"},
      {[](Terms& t) { t.nonbonded->cutoff = 0; }, "cutoff 0 nm"},
      {[](Terms&) {}, "cutoff 0.9 nm is over half the box's shortest edge, 0.85 nm", {4, 1.7, 4}},
      {[](Terms& t) { t.nonbonded->switch_distance = 0.9; }, "switch at 0.9 nm"},
      {[](Terms& t) { t.nonbonded->switch_distance = 0; }, "switch at 0 nm"},
      {[](Terms& t) { t.nonbonded->rf_dielectric = 0; }, "dielectric"},
      {[](Terms& t) { t.nonbonded->dielectric = 0; }, "dielectric 0 between charges"},
      {[](Terms& t) { t.nonbonded->shifted = true, t.nonbonded->switch_distance = 0.8; }, "take one"},
      {[&](Terms& t) { no_cutoff(t), t.nonbonded->shifted = true; }, "shifted to zero needs a cutoff"},
      {[&](Terms& t) { no_cutoff(t), t.nonbonded->rf_excluded = true; },
       "between excluded charges needs a cutoff"},
      {[](Terms& t) { t.nonbonded->dispersion_correction = true; }, "dispersion"},
      {[&](Terms& t) { no_cutoff(t), t.nonbonded->switch_distance = 0.8; }, "switch at 0.8 nm"},
      {[&](Terms& t) { no_cutoff(t), t.nonbonded->dispersion_correction = true; }, "dispersion", {4, 4, 4}},
      {[](Terms& t) { t.wca->sigma = 0; }, "wca: sigma"},
      {[](Terms& t) {
         t.wca->exclusions = {{0, 1}, {2, 2}};
       },
       "wca exclusion 1"},
      {[](Terms& t) { t.wca->sigma = 1; }, "wca: beads reach", {2, 2, 2}}};
  for (const auto& [spoil, words, edge] : all) {
    const std::string text = message(spoil, edge);
    EXPECT_NE(text.find(words), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace taut::forcefield_tests
