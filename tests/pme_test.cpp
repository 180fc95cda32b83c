#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "base/errors.hpp"
#include "every_machine.hpp"
#include "force_checks.hpp"
#include "forcefield/ewald/mesh.hpp"
#include "forcefield/ewald/parameters.hpp"
#include "forcefield/ewald/screening.hpp"
#include "md/units.hpp"
#include "reference/plain_ewald.hpp"
#include "reference/plain_mesh.hpp"

namespace taut::pme_tests {
namespace {

using namespace tests;

// Rock salt, an edge of two ions 1 apart: E = −M k q² per pair of ions, M = 1.747564594633.
TEST(Ewald, HasTheMadelungConstantOfRockSalt) {
  const int side = 2;
  const int n = side * side * side;
  Vectors x(3, n);
  Nonbonded nb;
  nb.charge.resize(n);
  for (int a = 0; a < n; ++a) {
    const int i = a % 2, j = a / 2 % 2, k = a / 4;
    x.col(a) = Vec3(i, j, k);
    nb.charge[a] = (i + j + k) % 2 ? -1 : 1;
  }
  const Box box{Vec3::Constant(2)};
  for (const double alpha : {1.5, 2.0, 3.0}) {
    const auto sum = plain_ewald(nb, box, x, alpha);
    EXPECT_NEAR(sum.energy / kCoulomb, -1.747564594633 * n / 2, 1e-9 * n / 2) << alpha;
    EXPECT_NEAR(sum.virial.trace(), sum.energy, 1e-9 * kCoulomb) << "of 1/r, all of it";
    EXPECT_LT(sum.f.norm(), 1e-9 * kCoulomb);
  }
}

const Box kBox{Vec3(1.9, 2.1, 2.3)}, kSkewed{Vec3(1.9, 2.1, 2.3), Vec3(-0.8, 0.6, 1.05)};

// Ions on a jittered lattice, some of them boxes away; pairs of them bonded. `surplus`: what charges add to.
struct Salt {
  Nonbonded nb;
  Box box;
  Vectors x;

  explicit Salt(double surplus, int side = 6, const Box& in = kBox) : box(in) {
    const int n = side * side * side;
    std::mt19937_64 rng(7);
    std::uniform_real_distribution<double> jitter(-0.1, 0.1);
    x.resize(3, n);
    nb.charge.resize(n);
    nb.sigma.setConstant(n, 0.2);
    nb.epsilon.setZero(n);
    for (int a = 0; a < n; ++a) {
      const Vec3 cell(a % side + jitter(rng), a / side % side + jitter(rng), a / side / side + jitter(rng));
      x.col(a) = box.edge.cwiseProduct(cell) / side;
      x.col(a) += box.lattice_vector(Vec3(a / 2 % 3 - 1, a / 2 % 5 - 2, a / 2 % 2));
      nb.charge[a] = (a % 2 ? -0.8 : 0.8) + (a % 7 == 0 ? 0.1 : 0.0);
      if (a % 10 == 1) nb.exceptions.push_back({a - 1, a, a % 20 == 1 ? 0.25 : 0.0, 0.2, 0.0});
    }
    if (n > 100) nb.exceptions.push_back({3, 100, 0.0, 0.2, 0.0});  // further off than any cutoff
    nb.charge.array() += (surplus - nb.charge.sum()) / n;
    nb.cutoff = 0.94;
  }
};

// Where α and the grid leave no error but rounding.
PmeParameters converged() {
  return {.order = 8, .alpha = 5.5, .grid = {160, 168, 192}};
}

TEST(Pme, ConvergesToEwaldsSum) {
  for (const auto& [surplus, box] : {std::pair{0.0, kBox}, {3.0, kBox}, {3.0, kSkewed}}) {
    Salt salt(surplus, 6, box);
    const auto plain = plain_ewald(salt.nb, salt.box, salt.x, 4);
    const auto other = plain_ewald(salt.nb, salt.box, salt.x, 3);
    EXPECT_NEAR(plain.energy, other.energy, 1e-12 * std::abs(plain.energy));
    EXPECT_LT((plain.f - other.f).norm(), 1e-12 * plain.f.norm());
    EXPECT_NEAR(plain.virial.trace(), plain.energy, 1e-11 * std::abs(plain.energy));
    salt.nb.pme = converged();
    Bench bench(static_cast<int>(salt.x.cols()), {.nonbonded = salt.nb}, salt.box);
    const auto ours = bench.at(salt.x);
    EXPECT_NEAR(ours.energy, plain.energy, 1e-10 * std::abs(plain.energy)) << surplus;
    EXPECT_LT((ours.f - plain.f).norm(), 1e-10 * plain.f.norm()) << surplus;
    EXPECT_LT((bench.virial_at(salt.x) - plain.virial).norm(), 1e-9 * plain.virial.norm()) << surplus;
  }
}

// As two states of one atom are, or a site and its parent.
TEST(Pme, ExcludedIonsMayBeInOnePlace) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int n = 4; n < 16; ++n) {
    SCOPED_TRACE(n);
    Nonbonded nb;
    nb.sigma = Eigen::VectorXd::Constant(n, 0.2);
    nb.epsilon = Eigen::VectorXd::Zero(n);
    nb.charge = Eigen::VectorXd::LinSpaced(n, -0.7, 0.9);
    nb.cutoff = 0.9;
    nb.pme = PmeParameters{.order = 8, .alpha = 5, .grid = {48, 54, 60}};
    Vectors x(3, n);
    for (int a = 0; a < n; ++a) {
      x.col(a) = kSkewed.edge.cwiseProduct(Vec3(uniform(rng), uniform(rng), uniform(rng)));
      if (a % 2 == 0) continue;
      x.col(a) = x.col(a - 1);
      nb.exceptions.push_back({a - 1, a, 0, 0.2, 0});
    }
    const auto plain = plain_ewald(nb, kSkewed, x, 3);
    for (const auto& [precision, digits] : {std::pair{Precision::kDouble, 5e-6}, {Precision::kMixed, 1e-3}})
      on_every_machine([&, digits = digits, precision = precision] {
        Bench bench(n, {.nonbonded = nb, .precision = precision}, kSkewed);
        const auto ours = bench.at(x);
        EXPECT_NEAR(ours.energy, plain.energy, digits * std::abs(plain.energy));
        EXPECT_LT((ours.f - plain.f).norm(), digits * plain.f.norm());
        EXPECT_LT((bench.virial_at(x) - plain.virial).norm(), 10 * digits * plain.virial.norm());
      });
  }
}

// The finer the grid, by the spacing to the power of the order, or of one less where that is even: forces are
// slopes.
TEST(Pme, GoesToEwaldsSumAsItsOrderSays) {
  Salt salt(0);
  const auto plain = plain_ewald(salt.nb, salt.box, salt.x, 4);
  constexpr std::array kMost = {1.2e-3, 3e-5, 7e-6, 4e-7, 8e-8};
  for (int order = 4; order <= 8; ++order) {
    const auto error = [&](std::array<int, 3> grid) {
      salt.nb.pme = PmeParameters{.order = order, .alpha = 5.5, .grid = grid};
      const auto ours = evaluate({.nonbonded = salt.nb}, salt.x, salt.box);
      return (ours.f - plain.f).norm() / plain.f.norm();
    };
    const double coarse = error({28, 30, 35}), fine = error({56, 60, 70});
    EXPECT_GT(coarse / fine, std::pow(2, order - 1.5)) << order << ": " << coarse << " " << fine;
    EXPECT_LT(fine, kMost[order - 4]) << order;
  }
}

TEST(Pme, IsAsExactAsItsToleranceSays) {
  Salt salt(0);
  const auto plain = plain_ewald(salt.nb, salt.box, salt.x, 4);
  for (const double tolerance : {1e-3, 5e-4, 1e-5, 1e-6}) {
    salt.nb.pme = PmeParameters{.tolerance = tolerance};
    for (const Precision precision : {Precision::kDouble, Precision::kMixed})
      on_every_machine([&] {
        const auto ours = evaluate({.nonbonded = salt.nb, .precision = precision}, salt.x, salt.box);
        EXPECT_LT((ours.f - plain.f).norm(), 3 * tolerance * plain.f.norm());
        EXPECT_GT((ours.f - plain.f).norm(), 0.001 * tolerance * plain.f.norm()) << "wasteful";
      });
  }
}

// What is foretold of α and grids that somebody chose: by how much forces are wrong, or somewhat more.
TEST(Pme, ErrorsAreForetold) {
  Salt salt(0);
  const auto plain = plain_ewald(salt.nb, salt.box, salt.x, 4);
  const auto error = [&](const PmeParameters& p) {
    salt.nb.pme = p;
    return (evaluate({.nonbonded = salt.nb}, salt.x, salt.box).f - plain.f).norm() / plain.f.norm();
  };
  const auto expect_foretold = [&](double foretold, double measured, const PmeParameters& p) {
    EXPECT_LT(measured, 3 * foretold) << p.alpha << " " << p.order << " " << p.grid[0];
    EXPECT_GT(measured, 0.03 * foretold) << p.alpha << " " << p.order << " " << p.grid[0];
  };
  for (const double alpha : {0.01, 1.0, 2.0, 2.5, 3.0}) {
    const PmeParameters p{.order = 8, .alpha = alpha, .grid = {48, 54, 60}};
    expect_foretold(ewald_errors(p, salt.box, *salt.nb.cutoff).pairs, error(p), p);
  }
  for (const int order : {4, 5, 6, 8})
    for (const std::array<int, 3> grid : {std::array{14, 16, 18}, {20, 21, 24}, {28, 30, 35}}) {
      const PmeParameters p{.order = order, .alpha = 5.5, .grid = grid};
      const double foretold = ewald_errors(p, salt.box, *salt.nb.cutoff).mesh;
      if (foretold < 0.3) expect_foretold(foretold, error(p), p);
    }
}

// The pairs, and with a cutoff that none are within the mesh, whose energy is much the same number less
// another.
TEST(Pme, MixedPrecisionAgreesToItsDigits) {
  for (const auto& [cutoff, alpha] : {std::pair{0.94, 0.0}, {0.05, 4.0}}) {
    Salt salt(0);
    salt.nb.cutoff = cutoff;
    salt.nb.pme = PmeParameters{.alpha = alpha};
    Terms terms;
    terms.nonbonded = salt.nb;
    const auto exact = evaluate(terms, salt.x, salt.box);
    terms.precision = Precision::kMixed;
    on_every_machine([&] {
      const auto mixed = evaluate(terms, salt.x, salt.box);
      EXPECT_LT((mixed.f - exact.f).norm(), 2e-6 * exact.f.norm());
      EXPECT_GT((mixed.f - exact.f).norm(), 1e-10 * exact.f.norm()) << "is it mixed?";
      EXPECT_NEAR(mixed.energy, exact.energy, 1e-6 * std::abs(exact.energy));
    });
  }
}

// On grids so coarse that the waves at their ends, m = ±K/2 of even ones, count: in skewed boxes the two
// signs are of different lengths.
TEST(PmeMesh, IsTheSumOverAllWavesThatIsWrittenDown) {
  const Salt salt(1, 2);
  const auto expect_the_sum = [&](const Box& box, const PmeParameters& p) {
    const Vectors x = box.vectors() * kBox.vectors().inverse() * salt.x;
    const auto plain = plain_mesh(salt.nb.charge, p, box, x);
    on_every_machine([&] {
      for (const auto& [precision, digits] :
           {std::pair{Precision::kDouble, 1e-12}, std::pair{Precision::kMixed, 1e-5}}) {
        PmeMesh mesh(salt.nb.charge, p, precision);
        mesh.set_box(box);
        Vectors f = Vectors::Zero(3, x.cols());
        EXPECT_NEAR(mesh.add_forces(x, f), plain.energy, digits * plain.energy);
        EXPECT_LT((f - plain.f).norm(), digits * plain.f.norm());
        EXPECT_LT((mesh.virial(x) - plain.virial).norm(), digits * plain.virial.norm());
      }
    });
  };
  const Vec3 edge = kBox.edge;
  for (const Vec3& tilt : {Vec3(0, 0, 0), Vec3(-0.8, 0, 0), Vec3(0, 0.6, 0), Vec3(0, 0, 1.05),
                           Vec3(0.95, -0.95, 0.7), kSkewed.tilt})
    for (int odd = 0; odd < 8; ++odd) {
      const std::array grid{12 + odd % 2, 8 + odd / 2 % 2, 10 + odd / 4};
      SCOPED_TRACE(fmt::format("{} x {} x {}, tilted by {} {} {}", grid[0], grid[1], grid[2], tilt[0],
                               tilt[1], tilt[2]));
      for (const int order : {4, 5}) expect_the_sum({edge, tilt}, {.order = order, .alpha = 5, .grid = grid});
    }
}

// But for the pairs', whose sums go by threads: here there are none.
TEST(Pme, IsTheSameBitsOnAnyNumberOfThreads) {
  Salt salt(0, 9);
  salt.nb.cutoff = 0.05;
  salt.nb.pme = PmeParameters{.alpha = 4};
  salt.nb.exceptions.clear();
  for (int first = 0; first + 4 <= salt.x.cols(); first += 4)
    for (int i = first; i < first + 4; ++i)
      for (int j = i + 1; j < first + 4; ++j) salt.nb.exceptions.push_back({i, j, 0.0, 0.2, 0.0});
  ASSERT_GT(salt.nb.exceptions.size(), 1024u);  // enough for two threads
  const auto once = evaluate({.nonbonded = salt.nb}, salt.x, salt.box);
  EXPECT_GT(once.f.norm(), 0);
  std::reverse(salt.nb.exceptions.begin(), salt.nb.exceptions.end());
  const auto whole = evaluate({.nonbonded = salt.nb}, salt.x, salt.box);
  EXPECT_NEAR(once.energy, whole.energy, 1e-12 * std::abs(once.energy));
  EXPECT_LT((once.f - whole.f).norm(), 1e-12 * once.f.norm());
  std::reverse(salt.nb.exceptions.begin(), salt.nb.exceptions.end());
  auto of_one_molecule = salt.nb;
  of_one_molecule.exceptions.clear();
  const int atoms = static_cast<int>(salt.x.cols());
  for (int i = 0; i < atoms; ++i)
    for (int j = i + 1; j < std::min(i + 6, atoms); ++j)
      of_one_molecule.exceptions.push_back({i, j, 0.0, 0.2, 0.0});
  for (const Precision precision : {Precision::kDouble, Precision::kMixed})
    for (const Nonbonded& nb : {salt.nb, of_one_molecule}) {
      const auto alone = evaluate({.nonbonded = nb, .precision = precision}, salt.x, salt.box);
      on_one_to_three_threads([&] {
        const auto again = evaluate({.nonbonded = nb, .precision = precision}, salt.x, salt.box);
        EXPECT_EQ(alone.f, again.f);
        EXPECT_EQ(alone.energy, again.energy);
      });
    }
}

TEST(PmeParameters, AreThoseOfOpenMM) {
  const auto p = chosen_parameters({}, Box{Vec3(3, 4, 5)}, 0.9);
  EXPECT_NEAR(p.alpha, std::sqrt(-std::log(1e-3)) / 0.9, 1e-15);
  EXPECT_EQ(p.grid, (std::array{27, 36, 45}));  // 26.7, 35.6, 44.5
  EXPECT_EQ(chosen_parameters({.grid = {22, 23, 26}}, Box{Vec3(3, 4, 5)}, 0.9).grid,
            (std::array{22, 23, 26}));
  EXPECT_EQ(chosen_parameters({}, Box{Vec3(0.2, 2.8, 3.2)}, 0.9).grid,
            (std::array{6, 25, 30}));  // 24.9 and 28.5
}

TEST(PmeParameters, ThatNoSumCanBeMadeOfAreRefused) {
  const Box box{Vec3(3, 3, 3)};
  for (const PmeParameters& p :
       {PmeParameters{.tolerance = 1e-14}, PmeParameters{.tolerance = 0}, PmeParameters{.tolerance = 0.5},
        PmeParameters{.order = 3}, PmeParameters{.order = 9}, PmeParameters{.alpha = -1},
        PmeParameters{.alpha = 9}, PmeParameters{.grid = {4, 20, 20}},
        PmeParameters{.grid = {2000, 2000, 2000}}})
    EXPECT_THROW(chosen_parameters(p, box, 0.9), InputError);
}

TEST(Screening, IsWhatItsPolynomialsSay) {
  const ScreeningFit one{.error = 1e-15}, eight{8, 11, 2e-13}, sixteen{16, 5, 2e-6};
  for (const double alpha : {0.5, 2.9, 3.2, 5.0, 8.0})
    for (const ScreeningFit& fit : {one, eight, sixteen}) {
      SCOPED_TRACE(fmt::format("{}/nm, {} intervals", alpha, fit.intervals));
      const Screening screening(alpha, 1, fit);
      const auto value = [&](const std::vector<double>& c, double r) {
        const double u = screening.scale * r * r, t = u - (fit.intervals == 1 ? 0.5 : std::round(u));
        const auto interval = fit.intervals == 1 ? 0 : std::lround(u);
        double sum = 0;
        for (std::size_t k = c.size() / fit.intervals; k-- > 0;)
          sum = sum * t + c[k * fit.intervals + interval];
        return sum;
      };
      const double error = std::max(4e-15, 3 * fit.error);
      for (double r = 0.01; r <= 1; r += 0.01) {
        const long double u = (long double)(alpha)*r, energy = std::erf(u) / r;
        const long double decay = 2 * alpha / std::sqrt(std::numbers::pi_v<long double>) * std::exp(-u * u);
        const double force = static_cast<double>((energy - decay) / r / r);
        EXPECT_NEAR(value(screening.energy, r), static_cast<double>(energy), error * 1.13 * alpha) << r;
        EXPECT_NEAR(value(screening.force, r), force, error * std::pow(alpha, 3)) << r;
      }
      EXPECT_LE(screening.force.size(), kMostScreeningNumbers);
      if (alpha == 2.9) {
        EXPECT_LE(screening.force.size(), std::size_t(fit.intervals == 1 ? 22 : fit.intervals * fit.terms));
      }
    }
}

}  // namespace
}  // namespace taut::pme_tests
