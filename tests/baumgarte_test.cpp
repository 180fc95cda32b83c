#include "constraints/methods/baumgarte.hpp"

#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "constraints/bond_algebra.hpp"
#include "constraints/methods/guess.hpp"
#include "constraints/projection.hpp"
#include "free_system.hpp"
#include "md/observables.hpp"

namespace taut::baumgarte_tests {
namespace {

using tests::NoForce;

Baumgarte::Options numbers(double alpha, double beta, int passes = 2) {
  return {.gains = "numbers",
          .damping = "implicit",
          .alpha_per_ps = alpha,
          .beta_per_ps = beta,
          .passes = passes};
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
    EXPECT_NEAR(s.f(0, 0), pull / 2, 1e-12);
    EXPECT_NEAR(s.f(0, 1), pull / 2, 1e-12);
    EXPECT_NEAR(tensions(sys, method.lambda())[0], pull / 2, 1e-12);
  }
}

// A residual σ with σ̇ = 0 adds −β²σ to σ̈.
TEST(Baumgarte, AResidualAddsMinusBetaSquaredSigma) {
  const struct { double gain, sigma, added; } cases[] = {{10, 0.01, -1.0}, {20, 0.005, -2.0}};
  for (const auto& c : cases) {
    auto [sys, s] = tests::rotor(0);
    s.x(0, 1) = -0.5 + std::sqrt(1 + 2 * c.sigma);
    Baumgarte method(sys, numbers(c.gain, c.gain), 1e-3);
    EXPECT_TRUE(method.add_forces(sys, Push::at_start(1e-3), s).converged());
    const Vec3 r = s.x.col(1) - s.x.col(0);
    const double acceleration = r.dot(s.f.col(1) - s.f.col(0));  // σ̈ at rest
    EXPECT_NEAR(acceleration, c.added, 1e-12);
  }
}

// ... and a rate σ̇ adds −2ασ̇.
TEST(Baumgarte, ARateAddsMinusTwiceAlphaSigmaDot) {
  auto [sys, s] = tests::rotor(0);
  s.v(0, 1) = 0.3;
  Baumgarte method(sys, numbers(10, 10), 1e-3);
  EXPECT_TRUE(method.add_forces(sys, Push::at_start(1e-3), s).converged());
  const Vec3 r = s.x.col(1) - s.x.col(0);
  EXPECT_NEAR(r.dot(s.f.col(1) - s.f.col(0)) + 0.09, -2 * 10 * 0.3, 1e-12);  // σ̈ = r·a + |v|²
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

// |v|² and, under centred damping, v·a are taken with λ*: where bonds meet one pass feeds
//     −(1 + αh) h³ v·M⁻¹Jᵀ(λ* − λ)  (centred),   −h³ v·M⁻¹Jᵀ(λ* − λ)  (implicit, lagged)
// into the law's recurrence, up to terms smaller by h. The discrete law is fed, y = M⁻¹Jᵀ(λ* − λ),
//     −(1 + αh) h³ (v + ½h(a + y))·y   without remainder.
// h: of a chain at unit temperature, of waters at 300 K.
void expect_fed_as_foretold(const tests::Start& from, double h, const Guess& guessing) {
  const double ah = 1, bh = 1.4;
  for (const Damping damping : {Damping::kDiscrete, Damping::kCentred, Damping::kImplicit}) {
    tests::Start start = from;
    const System& sys = start.system;
    State& s = start.state;
    const auto [first, second] = damping == Damping::kDiscrete ? guessing : kThird;
    const int m = sys.bond_count();
    Baumgarte method(sys,
                     {.gains = "numbers",
                      .damping = std::string(name_of(damping)),
                      .alpha_per_ps = ah / h,
                      .beta_per_ps = bh / h},
                     h);
    NoForce forces;
    initialize({sys, forces, method}, h, s);
    const auto residuals = [&] {
      Eigen::VectorXd sigmas(m);
      for (int k = 0; k < m; ++k)
        sigmas[k] = sigma(s.x.col(sys.bonds[k].j) - s.x.col(sys.bonds[k].i), sys.bonds[k].length);
      return sigmas;
    };
    std::vector<Eigen::VectorXd> sigmas, lambdas;
    double off = 0, size = 0;
    State at;  // the step before
    for (int n = 0; n < 40; ++n) {
      EXPECT_TRUE(step({sys, forces, method}, h, s).converged());
      sigmas.push_back(residuals());
      lambdas.push_back(method.lambda());
      if (n > 10) {  // the law at step n − 1
        const Eigen::VectorXd guess = lambdas[n - 2] + first * (lambdas[n - 2] - lambdas[n - 3]) +
                                      second * (lambdas[n - 3] - lambdas[n - 4]);
        Vectors r(3, m), missed = Vectors::Zero(3, sys.atoms());
        differences(sys, at.x, r);
        add_constraint_acceleration(sys, r, guess - lambdas[n - 1], missed);
        for (int k = 0; k < m; ++k) {
          const auto& [i, j, d] = sys.bonds[k];
          const Vec3 v = at.v.col(j) - at.v.col(i);
          const Vec3 a = sys.inv_mass[j] * at.f.col(j) - sys.inv_mass[i] * at.f.col(i);
          const Vec3 y = missed.col(j) - missed.col(i);
          const bool discrete = damping == Damping::kDiscrete,
                     centred = discrete || damping == Damping::kCentred;
          const double fed = (1 + ah) * sigmas[n][k] - (2 - bh * bh) * sigmas[n - 1][k] +
                             (1 - ah) * sigmas[n - 2][k] -
                             (discrete ? 0 : std::pow(h, 4) / 4 * a.squaredNorm()) -
                             (centred ? 0 : ah * std::pow(h, 3) * v.dot(a));
          const double foretold =
              -(centred ? 1 + ah : 1) * std::pow(h, 3) * (discrete ? Vec3(v + 0.5 * h * (a + y)) : v).dot(y);
          off += std::pow(fed - foretold, 2);
          size += std::pow(foretold, 2);
        }
      }
      at = s;
    }
    EXPECT_GT(std::sqrt(size), 1e-11);
    EXPECT_LT(std::sqrt(off / size), damping == Damping::kDiscrete ? 1e-4 : 0.05) << name_of(damping);
  }
}

// Of λ = t it misses −⅔ of a step, of t² nothing; extrapolation to first order misses −2 of t².
TEST(Guess, OfAThirdMissesNoSecondDerivative) {
  const auto guess = [](const Guess& g, double one, double two) { return one + g.first * (one - two); };
  EXPECT_NEAR(guess(kThird, -1, -2), -2.0 / 3, 1e-15);
  EXPECT_NEAR(guess(kThird, 1, 4), 0, 1e-15);
  EXPECT_EQ(guess({1, 0}, 1, 4), -2);
}

TEST(Baumgarte, OnePassFeedsWhatTheGuessMisses) {
  expect_fed_as_foretold(tests::free_chain(6, 3), 0.002, kThird);
  expect_fed_as_foretold(tests::waters(5, 3, 300), 0.0002, kOfSmallClusters);
}

// With a sweep from the last multipliers in place of a solve: held where damping is strong and the feedback
// soft, and not with gains that leave the parasitic root undamped.
TEST(Baumgarte, OneSweepHoldsAChainWithSoftStronglyDampedGains) {
  const double h = 0.01;
  const auto error_with = [&](double ah, double bh, int sweeps) {
    auto [sys, s] = tests::free_chain(20, 1);
    Baumgarte method(
        sys, {.gains = "numbers", .alpha_per_ps = ah / h, .beta_per_ps = bh / h, .sweeps = sweeps}, h);
    NoForce forces;
    initialize({sys, forces, method}, h, s);
    double worst = 0;
    for (int n = 0; n < 1000 && worst < 1; ++n) {
      EXPECT_TRUE(step({sys, forces, method}, h, s).converged());
      worst = std::max(worst, bond_errors(sys, s.x).max);
    }
    return worst;
  };
  EXPECT_LT(error_with(1, 0.5, 1), 2e-3);
  EXPECT_LT(error_with(1, 0.5, 4), 0.3 * error_with(1, 0.5, 1));
  EXPECT_GT(error_with(0.1, 1.4, 1), 0.1);
  EXPECT_LT(error_with(0.1, 1.4, 16), 1e-4);
}

TEST(Baumgarte, CountsItsSolvesAndSweeps) {
  auto [sys, s] = tests::free_chain(5, 1);
  const auto counted = [&, &sys = sys, &start = s](int passes, int sweeps) {
    State state = start;
    Baumgarte method(sys, {.passes = passes, .sweeps = sweeps}, 0.01);
    return method.add_forces(sys, Push::between_steps(0.01), state).iterations;
  };
  EXPECT_EQ(counted(2, 0), 2);
  EXPECT_EQ(counted(1, 3), 3);
  EXPECT_EQ(counted(2, 3), 6);
}

}  // namespace
}  // namespace taut::baumgarte_tests
