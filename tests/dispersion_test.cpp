#include "forcefield/pairs/dispersion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "force_checks.hpp"
#include "two_kinds.hpp"

namespace taut::dispersion_tests {
namespace {

using namespace tests;
using std::numbers::pi;

double simpson(const std::function<double(double)>& g, double a, double b) {
  const int n = 4000;
  double sum = g(a) + g(b);
  for (int k = 1; k < n; ++k) sum += (k % 2 ? 4 : 2) * g(a + (b - a) * k / n);
  return sum * (b - a) / (3 * n);
}

TEST(Dispersion, TailsOfSwitchesAgreeWithQuadrature) {
  const double rc = 0.9;
  for (double rs : {0.2, 0.3, 0.7, 0.8, 0.87})
    for (int n : {4, 10}) {
      const auto integrand = [&](double r) {
        const double u = (r - rs) / (rc - rs);
        return u * u * u * (10 - 15 * u + 6 * u * u) * std::pow(r, -n);
      };
      const double expected = simpson(integrand, rs, rc) + std::pow(rc, 1 - n) / (n - 1);
      EXPECT_NEAR(cut_tail(rs, rc, n), expected, 1e-8 * expected) << rs << " " << n;
    }
}

// The weight −S' has the mean m = ½(rs + rc) and the variance w²/28: powers 0 and −1 by hand.
TEST(Dispersion, TailsOfSwitchesAreExactWherePowersAre) {
  const double rc = 0.9;
  for (double rs : {1e-9, 1e-3, 0.1, 0.5, 0.899, 0.9 - 1e-9}) {
    const double m = (rs + rc) / 2, w = rc - rs;
    EXPECT_NEAR(cut_tail(rs, rc, 0), -m, 1e-14) << rs;
    EXPECT_NEAR(cut_tail(rs, rc, -1), -(m * m + w * w / 28) / 2, 1e-14) << rs;
  }
}

// Half the width sooner than the cutoff, to first order in the width: for n = 4, 1/(3r³) at (rs + rc)/2.
TEST(Dispersion, ASwitchOnTheCutoffIsACutoff) {
  const double rc = 0.9;
  for (int n : {4, 10}) {
    const double plain = std::pow(rc, 1 - n) / (n - 1);
    EXPECT_DOUBLE_EQ(cut_tail(rc, rc, n), plain);
    for (double width : {1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-12, 1e-15}) {
      const double middle = std::pow(rc - width / 2, 1 - n) / (n - 1);
      EXPECT_NEAR(cut_tail(rc - width, rc, n) / middle, 1, n * n * width * width + 2e-15) << width;
    }
  }
}

// ½N² times the mean over all pairs, self pairs included, of ∫ U (1 − S) 4πr² dr; from the cutoff on in 1/r.
double tail_by_quadrature(const Nonbonded& nb) {
  const double rc = *nb.cutoff, rs = nb.switch_distance.value_or(rc);
  const int n = static_cast<int>(nb.sigma.size());
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = i; j < n; ++j) {
      const double sigma = (nb.sigma[i] + nb.sigma[j]) / 2,
                   epsilon = std::sqrt(nb.epsilon[i] * nb.epsilon[j]);
      const auto shell = [&](double r) { return lj(sigma, epsilon, r) * 4 * pi * r * r; };
      sum += simpson([&](double u) { return u > 0 ? shell(1 / u) / (u * u) : 0.0; }, 0, 1 / rc);
      if (rs < rc)
        sum += simpson(
            [&](double r) {
              const double u = (r - rs) / (rc - rs);
              return shell(r) * u * u * u * (10 - 15 * u + 6 * u * u);
            },
            rs, rc);
    }
  return 0.5 * n * n * sum / (n * (n + 1) / 2.0);
}

TEST(Dispersion, CoefficientAgreesWithQuadratureOverAllPairs) {
  Nonbonded nb = two_kinds(7);
  nb.epsilon[3] = 0;
  nb.cutoff = 0.9;
  EXPECT_NEAR(dispersion_coefficient(nb), tail_by_quadrature(nb), 1e-9 * std::abs(tail_by_quadrature(nb)));
  EXPECT_LT(dispersion_coefficient(nb), 0);
  const double plain = dispersion_coefficient(nb);
  nb.switch_distance = 0.7;
  EXPECT_NEAR(dispersion_coefficient(nb), tail_by_quadrature(nb), 1e-9 * std::abs(tail_by_quadrature(nb)));
  EXPECT_LT(dispersion_coefficient(nb), 1.1 * plain);  // the switch took more away
}

TEST(Dispersion, IsTheSameWhereATableSaysWhatMixingGives) {
  Nonbonded nb = two_kinds(7);
  nb.cutoff = 0.9;
  nb.switch_distance = 0.7;
  const double mixed = dispersion_coefficient(nb);
  LennardJonesTable table{{0, 1, 0, 1, 0, 1, 0}, Eigen::MatrixXd(2, 2), Eigen::MatrixXd(2, 2)};
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      const double s6 = std::pow((nb.sigma[i] + nb.sigma[j]) / 2, 6),
                   e = std::sqrt(nb.epsilon[i] * nb.epsilon[j]);
      table.a(i, j) = 4 * e * s6 * s6;
      table.b(i, j) = 4 * e * s6;
    }
  nb.lj_table = table;
  EXPECT_NEAR(dispersion_coefficient(nb), mixed, 1e-13 * std::abs(mixed));
  nb.lj_table->b(0, 1) *= 2;
  nb.lj_table->b(1, 0) *= 2;
  EXPECT_LT(dispersion_coefficient(nb), 1.1 * mixed);
}

TEST(Dispersion, IsAConstantOverTheVolume) {
  Nonbonded nb = without_charges(two_kinds(2));
  nb.cutoff = 0.9;
  const Terms plain{.nonbonded = nb};
  nb.dispersion_correction = true;
  const Box box{Vec3(2, 2.5, 3)};
  const Vectors x = columns({{0, 0, 0}, {0.4, 0, 0}});
  const Evaluated with = evaluate({.nonbonded = nb}, x, box), without = evaluate(plain, x, box);
  EXPECT_NEAR(with.energy - without.energy, dispersion_coefficient(nb) / 15, 1e-15);
  EXPECT_EQ(with.f, without.f);
}

// One kind alone: Frenkel and Smit, Understanding Molecular Simulation, eq. 3.2.8 (energy) and 3.2.10
// (pressure),
//     U/N = 8πρεσ³ (⅓(σ/r_c)⁹ − (σ/r_c)³)/3,   P = 16πρ²εσ³ (⅔(σ/r_c)⁹ − (σ/r_c)³)/3.
TEST(Dispersion, VirialOfAPlainCutoffHasItsJump) {
  Nonbonded nb;
  nb.sigma.setConstant(8, 0.3);
  nb.epsilon.setConstant(8, 0.7);
  nb.cutoff = 0.9;
  const double s3 = 1 / 27.0, per = 8 * pi * 64 * 0.7 * std::pow(0.3, 3) / 3;
  EXPECT_NEAR(dispersion_coefficient(nb), per * (s3 * s3 * s3 / 3 - s3), 1e-12);
  EXPECT_NEAR(dispersion_virial_coefficient(nb), 2 * per * (2 * s3 * s3 * s3 / 3 - s3), 1e-12);
  nb.switch_distance = 0.8;
  EXPECT_EQ(dispersion_virial_coefficient(nb), dispersion_coefficient(nb));
}

}  // namespace
}  // namespace taut::dispersion_tests
