#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "base/errors.hpp"
#include "force_checks.hpp"
#include "md/units.hpp"
#include "reference/plain_pairs.hpp"
#include "two_kinds.hpp"

namespace taut::nonbonded_tests {
namespace {

using namespace tests;

Vectors apart(double r) {
  return columns({{0, 0, 0}, {r, 0, 0}});
}

// ---- a pair, in closed form ----

TEST(LennardJones, MixesByLorentzAndBerthelot) {
  const Terms terms{.nonbonded = without_charges(two_kinds(2))};
  const double sigma = 0.25, epsilon = 0.4;
  EXPECT_NEAR(evaluate(terms, apart(sigma)).energy, 0, 1e-13);
  EXPECT_NEAR(evaluate(terms, apart(sigma)).f(0, 1), 24 * epsilon / sigma, 1e-10);  // pushed apart
  EXPECT_NEAR(evaluate(terms, apart(sigma)).f(0, 0), -24 * epsilon / sigma, 1e-10);
  const double bottom = std::pow(2, 1.0 / 6) * sigma;
  EXPECT_NEAR(evaluate(terms, apart(bottom)).energy, -epsilon, 1e-13);
  EXPECT_NEAR(evaluate(terms, apart(bottom)).f(0, 1), 0, 1e-11);
}

TEST(LennardJones, IsCutPlainlyOrSwitchedOff) {
  Nonbonded nb = without_charges(two_kinds(2));
  nb.cutoff = 0.9;
  for (double r : {0.3, 0.7, 0.8999})
    EXPECT_NEAR(evaluate({.nonbonded = nb}, apart(r)).energy, lj(0.25, 0.4, r), 1e-13);
  EXPECT_EQ(evaluate({.nonbonded = nb}, apart(0.9001)).energy, 0);

  nb.switch_distance = 0.7;
  EXPECT_NEAR(evaluate({.nonbonded = nb}, apart(0.6999)).energy, lj(0.25, 0.4, 0.6999), 1e-13);
  for (double u : {0.1, 0.5, 0.8}) {
    const double S = 1 - 6 * std::pow(u, 5) + 15 * std::pow(u, 4) - 10 * std::pow(u, 3), r = 0.7 + 0.2 * u;
    EXPECT_NEAR(evaluate({.nonbonded = nb}, apart(r)).energy, S * lj(0.25, 0.4, r), 1e-13);
  }
  EXPECT_NEAR(evaluate({.nonbonded = nb}, apart(0.89999)).energy, 0, 1e-12);
  EXPECT_EQ(evaluate({.nonbonded = nb}, apart(0.9001)).energy, 0);
}

TEST(Coulomb, IsPlainWithoutACutoff) {
  const auto [energy, f] =
      evaluate({.nonbonded = without_lj(two_kinds(2))}, apart(2), Box{Vec3(3, 3, 3)});  // no images
  EXPECT_NEAR(energy, kCoulomb * -0.4 / 2, 1e-12);
  EXPECT_NEAR(f(0, 1), kCoulomb * -0.4 / 4, 1e-12);  // drawn to the first
  EXPECT_NEAR(f(0, 0), kCoulomb * 0.4 / 4, 1e-12);
}

TEST(Coulomb, HasAReactionFieldWithinACutoff) {
  Nonbonded nb = without_lj(two_kinds(2));
  const double rc = 0.9;
  nb.cutoff = rc;
  for (double eps : {1.0, 4.0, 78.3}) {
    nb.rf_dielectric = eps;
    const double k_rf = (eps - 1) / ((2 * eps + 1) * rc * rc * rc), c_rf = 3 * eps / ((2 * eps + 1) * rc);
    for (double r : {0.2, 0.6, 0.89})
      for (const Box& box : {Box{}, Box{Vec3(2, 2, 2)}}) {
        const auto [energy, f] = evaluate({.nonbonded = nb}, apart(r), box);
        EXPECT_NEAR(energy, kCoulomb * -0.4 * (1 / r + k_rf * r * r - c_rf), 1e-11);
        EXPECT_NEAR(f(0, 1), kCoulomb * -0.4 * (1 / (r * r) - 2 * k_rf * r), 1e-10);
      }
    EXPECT_NEAR(evaluate({.nonbonded = nb}, apart(rc - 1e-12)).energy, 0, 1e-8);
    EXPECT_EQ(evaluate({.nonbonded = nb}, apart(rc + 1e-9)).energy, 0);
  }
}

// Martini's form (Marrink et al. 2007, doi:10.1021/jp071097f): the force is that of the plain cutoff.
TEST(LennardJones, IsShiftedToZeroAtTheCutoff) {
  Nonbonded nb = without_charges(two_kinds(2)), plain = nb;
  nb.cutoff = plain.cutoff = 0.9;
  nb.shifted = true;
  LennardJonesTable table{{0, 1}, Eigen::MatrixXd::Zero(2, 2), Eigen::MatrixXd::Zero(2, 2)};
  for (const auto& [i, j] : {std::pair{0, 1}, std::pair{1, 0}}) {
    table.a(i, j) = 4 * 0.4 * std::pow(0.25, 12);
    table.b(i, j) = 4 * 0.4 * std::pow(0.25, 6);
  }
  Nonbonded by_table = without_lj(nb);
  by_table.lj_table = table;
  Nonbonded alike = nb;
  alike.sigma.setConstant(0.25);
  alike.epsilon.setConstant(0.4);
  for (const double r : {0.3, 0.7, 0.8999})
    for (const Nonbonded& one : {nb, by_table, alike}) {
      EXPECT_NEAR(evaluate({.nonbonded = one}, apart(r)).energy, lj(0.25, 0.4, r) - lj(0.25, 0.4, 0.9),
                  1e-13);
      EXPECT_NEAR(evaluate({.nonbonded = one}, apart(r)).f(0, 1),
                  evaluate({.nonbonded = plain}, apart(r)).f(0, 1), 1e-12);
    }
  EXPECT_EQ(evaluate({.nonbonded = nb}, apart(0.9001)).energy, 0);
}

TEST(Coulomb, IsDividedByADielectricConstant) {
  Nonbonded nb = two_kinds(2);
  nb.dielectric = 15;
  nb.epsilon.setZero();
  EXPECT_NEAR(evaluate({.nonbonded = nb}, apart(2)).energy, kCoulomb * -0.4 / 2 / 15, 1e-13);
  nb.exceptions = {{1, 0, 0.3, 1, 0}};
  EXPECT_NEAR(evaluate({.nonbonded = nb}, apart(2)).energy, kCoulomb * 0.3 / 2 / 15, 1e-13);
}

// k_rf = 1/2rc³ and c_rf = 3/2rc of an infinite ε, of excluded charges within the cutoff and of each on itself.
TEST(Coulomb, HasAReactionFieldOfExcludedCharges) {
  Nonbonded nb = without_lj(two_kinds(2));
  const double rc = 1.1, one = nb.charge[0] * nb.charge[0] + nb.charge[1] * nb.charge[1];
  nb.cutoff = rc;
  nb.dielectric = 15;
  nb.rf_dielectric = HUGE_VAL;
  nb.rf_excluded = true;
  nb.exceptions = {{0, 1, 0, 1, 0}};
  for (const double r : {0.2, 0.6, 1.09, 1.2}) {
    const auto [energy, f] = evaluate({.nonbonded = nb}, apart(r), Box{Vec3(3, 3, 3)});
    const double within = r < rc ? 1 : 0, qq = kCoulomb / 15 * -0.4;
    EXPECT_NEAR(energy,
                within * qq * (r * r / (2 * rc * rc * rc) - 1.5 / rc) - 0.5 * kCoulomb / 15 * one * 1.5 / rc,
                1e-12);
    EXPECT_NEAR(f(0, 1), -within * qq * r / (rc * rc * rc), 1e-12);
  }
  expect_forces_are_minus_the_slope({.nonbonded = nb}, apart(0.6));
}

TEST(Exceptions, GoByTheirOwnNumbersWithoutCutoffOrImages) {
  Nonbonded nb = two_kinds(2);
  nb.cutoff = 0.9;
  nb.switch_distance = 0.7;
  nb.exceptions = {{1, 0, 0.3, 0.4, 0.5}};
  for (double r : {0.4, 0.8, 1.7}) {
    const double s6 = std::pow(0.4 / r, 6);
    const auto [energy, f] = evaluate({.nonbonded = nb}, apart(r), Box{Vec3(2, 2, 2)});
    EXPECT_NEAR(energy, lj(0.4, 0.5, r) + kCoulomb * 0.3 / r, 1e-11);
    EXPECT_NEAR(f(0, 1), (24 * 0.5 * (2 * s6 * s6 - s6) + kCoulomb * 0.3 / r) / r, 1e-9);
  }
  nb.exceptions = {{1, 0, 0, 1, 0}};
  const auto [energy, f] = evaluate({.nonbonded = nb}, apart(0.3));
  EXPECT_EQ(energy, 0);
  EXPECT_EQ(f.norm(), 0);
}

TEST(Wca, IsRepulsionUpToTheMinimum) {
  const double sigma = 0.3, epsilon = 2;
  const Terms terms{.wca = Wca{sigma, epsilon, {}}};
  for (const Box& box : {Box{}, Box{Vec3(1, 1, 1)}}) {
    EXPECT_NEAR(evaluate(terms, apart(sigma), box).energy, epsilon, 1e-12);
    EXPECT_NEAR(evaluate(terms, apart(sigma), box).f(0, 1), 24 * epsilon / sigma, 1e-10);
    EXPECT_NEAR(evaluate(terms, apart(0.25), box).energy, lj(sigma, epsilon, 0.25) + epsilon, 1e-10);
    const double reach = std::pow(2, 1.0 / 6) * sigma;
    EXPECT_NEAR(evaluate(terms, apart(reach - 1e-9), box).energy, 0, 1e-12);
    EXPECT_EQ(evaluate(terms, apart(reach + 1e-9), box).energy, 0);
  }
  EXPECT_NEAR(evaluate(terms, apart(0.7), Box{Vec3(1, 1, 1)}).energy, evaluate(terms, apart(0.3)).energy,
              1e-12);
  EXPECT_EQ(evaluate({.wca = Wca{sigma, epsilon, {{1, 0}}}}, apart(0.25)).energy, 0);
}

// ---- many atoms, against a double loop ----

// Atoms on a jittered lattice, so that none are too close; some drifted a few boxes away.
Vectors crowd(int a, double spacing, bool drifted) {
  std::mt19937_64 rng(a);
  std::uniform_real_distribution<double> jitter(-0.2 * spacing, 0.2 * spacing);
  Vectors x(3, a * a * a);
  for (int k = 0; k < x.cols(); ++k) {
    const Vec3 cell(k % a, k / a % a, k / (a * a));
    x.col(k) = spacing * cell + Vec3(jitter(rng), jitter(rng), jitter(rng));
    if (drifted) x.col(k) += a * spacing * Vec3(k % 3 - 1, k % 5 - 2, k % 2);
  }
  return x;
}

Nonbonded mixed(int n) {  // charged, neutral, with and without Lennard-Jones
  Nonbonded nb = two_kinds(n);
  for (int a = 0; a < n; ++a) {
    if (a % 5 == 0) nb.charge[a] = 0;
    if (a % 3 == 0) nb.epsilon[a] = 0;
  }
  for (int a = 0; a + 1 < n; a += 2) nb.exceptions.push_back({a, a + 1, 0.1 * (a % 4), 0.2, 0.1 * (a % 3)});
  return nb;
}

TEST(Nonbonded, ForcesAreMinusTheSlope) {
  const Vectors x = crowd(3, 0.35, false);
  const Box none, box{Vec3(1.05, 1.1, 1.2)};
  for (const auto& change : std::initializer_list<std::function<Nonbonded(Nonbonded)>>{
           [](Nonbonded nb) { return nb; }, without_charges, without_lj}) {
    Nonbonded nb = change(mixed(27));
    expect_forces_are_minus_the_slope({.nonbonded = nb}, x, none);
    nb.cutoff = 0.5;
    expect_forces_are_minus_the_slope({.nonbonded = nb}, x, none);
    expect_forces_are_minus_the_slope({.nonbonded = nb}, x, box);
    nb.switch_distance = 0.3;  // most pairs are in the switch
    expect_forces_are_minus_the_slope({.nonbonded = nb}, x, none);
    expect_forces_are_minus_the_slope({.nonbonded = nb}, x, box);
  }
  expect_forces_are_minus_the_slope({.wca = Wca{0.35, 1.5, {{0, 1}, {4, 7}}}}, x, none);
  expect_forces_are_minus_the_slope({.wca = Wca{0.35, 1.5, {{0, 1}, {4, 7}}}}, x, box);
}

// Types of the last rows of the largest table find their own numbers, and one more is refused.
TEST(LennardJones, TablesAreServedUpToTheirLargest) {
  for (const int types : {2047, 2048}) {
    Nonbonded nb = without_lj(without_charges(two_kinds(3)));
    LennardJonesTable table{{types - 1, types - 2, 0},
                            Eigen::MatrixXd::Constant(types, types, 1e9),
                            Eigen::MatrixXd::Constant(types, types, 1e9)};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        table.a(table.type[i], table.type[j]) = 1e-7 * (1 + i + j);
        table.b(table.type[i], table.type[j]) = 1e-4 * (2 + i + j);
      }
    nb.lj_table = table;
    const Vectors x = columns({{0, 0, 0}, {0.3, 0, 0}, {0.1, 0.35, 0}});
    const auto plain = plain_pairs(nb, {}, x);
    for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
      const Terms terms{.nonbonded = nb, .precision = precision};
      if (types > 2047) {
        EXPECT_THROW(evaluate(terms, x), InputError);
        continue;
      }
      const auto ours = evaluate(terms, x);
      EXPECT_NEAR(ours.energy, plain.energy, 1e-6 * std::abs(plain.energy));
      EXPECT_LT((ours.f - plain.f).norm(), 1e-6 * plain.f.norm());
    }
  }
}

// ---- numbers that ran away ----

TEST(Nonbonded, OverlappingAtomsShowAsNumbersThatAreNotFinite) {
  Nonbonded nb = two_kinds(2);
  EXPECT_FALSE(std::isfinite(evaluate({.nonbonded = nb}, apart(0)).energy));
  nb.cutoff = 0.9;
  EXPECT_FALSE(std::isfinite(evaluate({.nonbonded = nb}, apart(0)).energy));
}

}  // namespace
}  // namespace taut::nonbonded_tests
