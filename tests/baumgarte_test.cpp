#include "constraints/methods/baumgarte.hpp"

#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "base/random.hpp"
#include "constraints/bond_algebra.hpp"
#include "constraints/projection.hpp"
#include "constraints/registry.hpp"
#include "free_system.hpp"
#include "md/observables.hpp"

namespace taut::baumgarte_tests {
namespace {

using tests::NoForce;

Baumgarte::Options numbers(double alpha, double beta) {
  return {.gains = "numbers", .alpha_per_ps = alpha, .beta_per_ps = beta, .tolerance = 1e-14};
}

// Two unit masses at distance 1, pulled by `pull` along the bond on one: both accelerate at half of it.
struct PullOnOne : ForceLaw {
  explicit PullOnOne(double its_pull) : pull(its_pull) {}
  double pull;
  void evaluate(const System&, State& s) override {
    s.f.setZero();
    s.f(0, 1) = pull;
  }
};

TEST(Baumgarte, HalfThePullIsTheTension) {
  for (const double pull : {10.0, 12.0}) {
    auto [sys, s] = tests::rotor(0);
    PullOnOne forces{pull};
    Baumgarte method(sys, numbers(10, 10), 1e-3);
    initialize({sys, forces, method}, 1e-3, s);
    EXPECT_NEAR(s.f(0, 0), pull / 2, 1e-8);
    EXPECT_NEAR(s.f(0, 1), pull / 2, 1e-8);
    EXPECT_NEAR(tensions(sys, method.lambda())[0], pull / 2, 1e-8);
  }
}

// A residual σ at rest adds −β²σ to σ̈, which is r·a + ¼h²|a|² there.
TEST(Baumgarte, AResidualAddsMinusBetaSquaredSigma) {
  const double h = 1e-3;
  const struct { double gain, sigma, added; } cases[] = {{10, 0.01, -1.0}, {20, 0.005, -2.0}};
  for (const auto& c : cases) {
    auto [sys, s] = tests::rotor(0);
    s.x(0, 1) = -0.5 + std::sqrt(1 + 2 * c.sigma);
    Baumgarte method(sys, numbers(c.gain, c.gain), h);
    EXPECT_TRUE(method.add_forces(sys, Push::at_start(h), s).converged());
    const Vec3 r = s.x.col(1) - s.x.col(0), a = s.f.col(1) - s.f.col(0);
    EXPECT_NEAR(r.dot(a) + 0.25 * h * h * a.squaredNorm(), c.added, 1e-8);
  }
}

// The σ of all bonds.
Eigen::VectorXd sigmas_of(const System& sys, const Vectors& x) {
  Eigen::VectorXd sigmas(sys.bond_count());
  for (int k = 0; k < sys.bond_count(); ++k)
    sigmas[k] = sigma(x.col(sys.bonds[k].j) - x.col(sys.bonds[k].i), sys.bonds[k].length);
  return sigmas;
}

// Every step takes the law whole, also where errors are large: (1 + αh)σ₊ = (2 − β²h²)σ − (1 − αh)σ₋, and under the
// textbooks' forms what (1) and (2) of README.md add to it, written down here with the velocity of the full step.
TEST(Baumgarte, EveryStepObeysItsLaw) {
  const double h = 0.01, ah = 0.3, bh2 = 1.7;
  for (const Damping damping : kDampings) {
    auto [sys, s] = tests::free_chain(6, 3);
    Baumgarte::Options options = numbers(ah / h, std::sqrt(bh2) / h);
    options.damping = name_of(damping);
    Baumgarte method(sys, options, h);
    tests::UniformForce forces{Vec3(0, 0, -9.81)};
    initialize({sys, forces, method}, h, s);
    Random random(4);
    State before, now = s;
    for (int n = 0; n < 30; ++n) {
      before = now;
      if (n % 5 == 0)  // a blow
        for (int a = 0; a < sys.atoms(); ++a) s.v.col(a) += 0.3 * random.normal_vector();
      now = s;
      const Vectors v = s.v;
      ASSERT_TRUE(step({sys, forces, method}, h, s).converged());
      if (n % 5 == 0 || n % 5 == 1) continue;  // v was not that of the drift that led to x
      const Eigen::VectorXd last = sigmas_of(sys, before.x), here = sigmas_of(sys, now.x),
                            next = sigmas_of(sys, s.x);
      for (int k = 0; k < sys.bond_count(); ++k) {
        const auto& [i, j, d] = sys.bonds[k];
        const Vec3 v_ij = v.col(j) - v.col(i),
                   a_ij = sys.inv_mass[j] * now.f.col(j) - sys.inv_mass[i] * now.f.col(i);
        const double a2 = std::pow(h, 4) / 4 * a_ij.squaredNorm();
        double off = (1 + ah) * next[k] - (2 - bh2) * here[k] + (1 - ah) * last[k];
        if (damping == Damping::kCentred) off -= a2;
        if (damping == Damping::kImplicit) off -= a2 + ah * std::pow(h, 3) * v_ij.dot(a_ij);
        if (damping == Damping::kLagged)
          off = next[k] - (2 - 2 * ah - bh2) * here[k] + (1 - 2 * ah) * last[k] - a2 +
                ah * h * h * (v_ij - 0.5 * h * a_ij).squaredNorm();
        EXPECT_NEAR(off, 0, damping == Damping::kDiscrete ? 3e-13 : 1e-8)
            << name_of(damping) << " step " << n << " bond " << k;
      }
      EXPECT_GT(here.cwiseAbs().maxCoeff(), damping == Damping::kDiscrete ? 1e-7 : 1e-6);
    }
  }
}

// One solve that changes λ by Δλ leaves ½|h²M⁻¹JᵀΔλ|², no more and no less, which the law then takes away as any error:
// (1 + αh)σ₊ = (2 − β²h²)σ − (1 − αh)σ₋ + (1 + αh)·½|h²M⁻¹JᵀΔλ|², at all gains.
TEST(Baumgarte, IsFedTheSquareOfWhatItsGuessMisses) {
  const double h = 0.002;
  for (const auto& [ah, bh2] : {std::pair{1.0, 2.0}, {0.3, 2.5}, {0.05, 0.5}, {3.0, 2.5}}) {
    auto [sys, s] = tests::waters(8, 1, 300);
    NoForce forces;
    Baumgarte::Options options = numbers(ah / h, std::sqrt(bh2) / h);
    options.tolerance = 0.1;  // never a second solve
    Baumgarte method(sys, options, h);
    initialize({sys, forces, method}, h, s);
    std::vector<Vectors> x = {s.x};
    std::vector<Eigen::VectorXd> lambda = {method.lambda()};
    double largest = 0;
    for (int n = 0; n < 60; ++n) {
      ASSERT_EQ(step({sys, forces, method}, h, s).iterations, 1);
      x.push_back(s.x);
      lambda.push_back(method.lambda());
      if (n < 5) continue;
      Vectors r(3, sys.bond_count()), y_ij = r, y = Vectors::Zero(3, sys.atoms());
      differences(sys, x[n], r);
      add_constraint_acceleration(sys, r, lambda[n] - 3 * (lambda[n - 1] - lambda[n - 2]) - lambda[n - 3], y);
      differences(sys, y, y_ij);
      const Eigen::VectorXd square = 0.5 * std::pow(h, 4) * y_ij.colwise().squaredNorm().transpose();
      const Eigen::VectorXd fed = (1 + ah) * sigmas_of(sys, x[n + 1]) - (2 - bh2) * sigmas_of(sys, x[n]) +
                                  (1 - ah) * sigmas_of(sys, x[n - 1]);
      EXPECT_LT((fed - (1 + ah) * square).cwiseAbs().maxCoeff(), 3e-15 + 1e-9 * square.maxCoeff())
          << ah << " " << n;
      largest = std::max(largest, square.maxCoeff());
    }
    EXPECT_GT(largest, 1e-15);
  }
}

// Of what is fed slowly the law lets (1 + αh)/(βh)² stand: half as much with αh = 0.3, (βh)² = 2.5 as
// at dead-beat. Free waters at one solve a step from the last λ.
TEST(Baumgarte, LetsStandOfASlowFeedWhatItsGainsSay) {
  const double h = 0.0005;
  const auto left = [&](double ah, double bh2) {
    auto [sys, s] = tests::waters(8, 1, 300);
    NoForce forces;
    Baumgarte::Options options = numbers(ah / h, std::sqrt(bh2) / h);
    options.tolerance = 0.1;  // never a second solve
    options.extrapolation = 0;
    Baumgarte method(sys, options, h);
    initialize({sys, forces, method}, h, s);
    double sum = 0;
    for (int n = 0; n < 300; ++n) {
      EXPECT_EQ(step({sys, forces, method}, h, s).iterations, 1);
      if (n >= 100) sum += sigmas_of(sys, s.x).squaredNorm();
    }
    return std::sqrt(sum);
  };
  const double dead_beat = left(1, 2);
  EXPECT_GT(dead_beat, 1e-13);
  EXPECT_NEAR(left(0.3, 2.5) / dead_beat, 1.3 / 2.5, 0.05 * 1.3 / 2.5);
}

// α = β = √(stiffness/μ), each bond by its own μ, and capped where the step cannot bear it.
TEST(Gains, PhysicalOnesAreTheRealBonds) {
  const double h = 0.0005, k = 4.5e5;
  const System water = tests::waters(1, 1, 300).system;
  const auto gains = choose_gains({.name = "physical", .stiffness = k}, Damping::kCentred, water, h);
  const double oh = 1 / 15.99943 + 1 / 1.007947, hh = 2 / 1.007947;
  EXPECT_NEAR(gains[0].beta, std::sqrt(k * oh), 1e-9);
  EXPECT_NEAR(gains[2].beta, std::sqrt(k * hh), 1e-9);
  EXPECT_EQ(gains[0].alpha, gains[0].beta);
  EXPECT_NEAR(
      choose_gains({.name = "physical", .stiffness = k}, Damping::kCentred, water, 0.01)[0].beta * 0.01, 1.9,
      1e-12);
}

// Lagged damping bears αh = βh up to 2(√2 − 1), of which physical gains take 0.95.
TEST(Gains, PhysicalOnesOfLaggedDampingAreCappedEarlier) {
  const double h = 0.01;
  const auto gains = choose_gains({.name = "physical"}, Damping::kLagged, tests::rotor(1).system, h);
  EXPECT_NEAR(gains[0].beta * h, 0.95 * 2 * (std::sqrt(2.0) - 1), 1e-12);
  EXPECT_NEAR(gains[0].alpha, gains[0].beta, 1e-12);
}

TEST(Gains, OfNoNameAreRefused) {
  const System sys = tests::rotor(1).system;
  EXPECT_THROW(choose_gains({.name = "dead-beet"}, Damping::kCentred, sys, 0.001), InputError);
  for (const char* name : {"rattle", "swept"})  // of no reduction
    EXPECT_THROW(choose_gains({.name = name}, Damping::kDiscrete, sys, 0.001), InputError) << name;
  EXPECT_THROW(choose_gains({.name = "numbers", .alpha_per_ps = 1.0}, Damping::kCentred, sys, 0.001),
               InputError);
  EXPECT_THROW(choose_gains({.name = "box2d"}, Damping::kLagged, sys, 0.001), InputError);  // αh = π
}

// αh and βh of the named gains, as their sources have them.
TEST(Gains, AreThoseOfTheirNames) {
  const double h = 0.002, pi = M_PI, root2 = std::sqrt(2.0);
  const System sys = tests::rotor(1).system;
  const auto expect = [&](const char* name, Damping damping, double ah, double bh) {
    const Gains gains = choose_gains({.name = name, .reduction = 0.25}, damping, sys, h)[0];
    EXPECT_NEAR(gains.alpha * h, ah, 1e-14) << name;
    EXPECT_NEAR(gains.beta * h, bh, 1e-14) << name;
  };
  for (const Damping damping : {Damping::kCentred, Damping::kImplicit}) {
    expect("reversible", damping, 0.1, root2);
    expect("dead-beat", damping, 1, root2);
    expect("hoomd", damping, 1, root2);  // 2ασ̇ = 2σ̇/h, β²σ = 2σ/h²
    expect("rattle", damping, 1, std::sqrt(1.5));
    expect("swept", damping, 15 / 17.0, std::sqrt(2 - 10 / 17.0));  // 2 − ½(1 + ¼)/(1 + 1/16)
    expect("critical", damping, 1, 1);
    expect("box2d", damping, pi, pi / 2);  // a spring of ¼/h hertz, β = 2π·¼/h, damping ratio α/β = 2
  }
  expect("reversible", Damping::kDiscrete, 0.3, std::sqrt(2.5));
  expect("critical", Damping::kLagged, 0.5, 0.5);
  expect("dead-beat", Damping::kLagged, 0.5, 1);
  expect("rattle", Damping::kLagged, 0.5, std::sqrt(0.75));
  expect("swept", Damping::kLagged, 15 / 32.0, std::sqrt(0.75));
}

// The extrapolation misses λ by Δλ = O(h^(p+1)) and what is fed is of its square: order 2p + 6. A pendulum of
// unit mass and length from horizontal: its bond force swings, nothing is constant.
double error_of_a_pendulum(double ah, double bh2, int extrapolation, double h) {
  const System sys = make_system(Eigen::Vector2d(0, 1), {{0, 1, 1.0}});
  State s;
  s.x = s.v = s.f = Vectors::Zero(3, 2);
  s.x(0, 1) = 1;
  tests::UniformForce forces{Vec3(0, 0, -9.81)};
  Baumgarte::Options options = numbers(ah / h, std::sqrt(bh2) / h);
  options.tolerance = 0.1;
  options.extrapolation = extrapolation;
  Baumgarte method(sys, options, h);
  initialize({sys, forces, method}, h, s);
  double worst = 0;
  for (int n = 0; n < 2 / h; ++n) {
    EXPECT_TRUE(step({sys, forces, method}, h, s).converged());
    if (s.t > 0.5) worst = std::max(worst, bond_errors(sys, s.x).max);
  }
  return worst;
}

TEST(Baumgarte, ErrorIsOfTheSquareOfWhatExtrapolationMisses) {
  for (const int p : {0, 1, 2}) {
    const double h = p == 2 ? 0.02 : 0.01;
    const double order =
        std::log2(error_of_a_pendulum(0.3, 2.5, p, 2 * h) / error_of_a_pendulum(0.3, 2.5, p, h));
    EXPECT_NEAR(order, 2 * p + 6, 0.6) << "extrapolated to order " << p;
  }
}

// With a sweep from the last multipliers in place of a solve: held where damping is strong and the feedback
// soft, and not with gains that leave the parasitic root undamped.
TEST(Baumgarte, OneSweepHoldsAChainWithSoftStronglyDampedGains) {
  const double h = 0.01;
  const auto error_with = [&](double ah, double bh) {
    auto [sys, s] = tests::free_chain(20, 1);
    Baumgarte method(
        sys,
        {.gains = "numbers", .alpha_per_ps = ah / h, .beta_per_ps = bh / h, .sweeps = 1, .extrapolation = 0},
        h);
    NoForce forces;
    initialize({sys, forces, method}, h, s);
    double worst = 0;
    for (int n = 0; n < 1000 && worst < 1; ++n) {
      EXPECT_TRUE(step({sys, forces, method}, h, s).converged());
      worst = std::max(worst, bond_errors(sys, s.x).max);
    }
    return worst;
  };
  EXPECT_LT(error_with(1, 0.5), 2e-3);
  EXPECT_GT(error_with(0.1, 1.4), 0.1);
}

TEST(Baumgarte, CountsItsSweeps) {
  auto [sys, s] = tests::free_chain(5, 1);
  Baumgarte method(sys, {.sweeps = 3}, 0.01);
  EXPECT_EQ(method.add_forces(sys, Push::between_steps(0.01), s).iterations, 3);
}

// Sweeps until nothing changes are the solve.
TEST(Baumgarte, ManySweepsAreASolve) {
  const double h = 0.01;
  const auto end = [&](int sweeps) {
    auto [sys, s] = tests::free_chain(8, 1);
    Baumgarte method(sys, {.sweeps = sweeps, .tolerance = 1e-14}, h);
    NoForce forces;
    initialize({sys, forces, method}, h, s);
    for (int n = 0; n < 50; ++n) EXPECT_TRUE(step({sys, forces, method}, h, s).converged());
    return s.x;
  };
  EXPECT_LT((end(400) - end(0)).cwiseAbs().maxCoeff(), 1e-10);
}

// What stays where 1 is fed in every step, at most: the sum of what one error leaves.
TEST(Baumgarte, PromisesItsToleranceTimesWhatTheLawMakesOfIt) {
  const System sys = tests::rotor(1).system;
  const double h = 0.01;
  const auto promised = [&](const MethodOptions& options) {
    return make_method(sys, options, h)->promised_error();
  };
  EXPECT_DOUBLE_EQ(promised(Feedforward::Options{}), 1e-5);
  EXPECT_NEAR(promised(Feedforward::Options{.tolerance = 1e-9}), 1e-9, 1e-15);
  // roots ½ and 0: 1 + ½ + ¼ + …
  EXPECT_NEAR(promised(Baumgarte::Options{.gains = "rattle", .reduction = 0.5, .tolerance = 1e-9}), 2e-9,
              1e-11);
  EXPECT_EQ(promised(default_options("none")), HUGE_VAL);
  EXPECT_EQ(promised(Baumgarte::Options{.damping = "centred"}), HUGE_VAL);
}

}  // namespace
}  // namespace taut::baumgarte_tests
