// Langevin's thermostat: what it leaves distributed as, and what it does to the bonds.

#include "ensembles/langevin.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/random.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "constraints/methods/newton.hpp"
#include "constraints/methods/rattle.hpp"
#include "constraints/projection.hpp"
#include "ensembles/noise.hpp"
#include "every_machine.hpp"
#include "free_system.hpp"
#include "md/observables.hpp"
#include "md/units.hpp"

namespace taut::langevin_tests {
namespace {

constexpr double kWarm = 1 / kBoltzmann;  // kT = 1 kJ/mol

template <class Method>
Method with_defaults(const System& sys, double h) {
  return Method(sys, typename Method::Options{}, h);
}

template <class Method>
class LangevinWith : public ::testing::Test {};
using MethodsUnderTest = ::testing::Types<Newton, Rattle, Baumgarte>;
TYPED_TEST_SUITE(LangevinWith, MethodsUnderTest);

TYPED_TEST(LangevinWith, NoFrictionChangesNothing) {
  const double h = 0.01;
  auto [sys, s] = tests::free_chain(10, 3);
  State other = s;
  tests::NoForce forces;
  auto method = with_defaults<TypeParam>(sys, h), alone = with_defaults<TypeParam>(sys, h);
  Langevin bath(sys, {.temperature = kWarm, .friction = 0}, h);
  initialize(bath, {sys, forces, method}, h, s);
  initialize({sys, forces, alone}, h, other);
  for (int n = 0; n < 50; ++n) {
    EXPECT_TRUE(bath.advance({sys, forces, method}, h, s).converged());
    EXPECT_TRUE(step({sys, forces, alone}, h, other).converged());
  }
  EXPECT_EQ(s.x, other.x);
  EXPECT_EQ(s.v, other.v);
}

// What changes the velocity has no part along the bonds, where the drift begins.
TYPED_TEST(LangevinWith, JumpsAlongTheTangent) {
  const double h = 0.01;
  auto [sys, s] = tests::free_chain(10, 3);
  tests::NoForce forces;
  auto method = with_defaults<TypeParam>(sys, h);
  Langevin bath(sys, {.temperature = kWarm, .friction = 5}, h);
  initialize(bath, {sys, forces, method}, h, s);
  for (int n = 0; n < 5; ++n) {
    EXPECT_TRUE(bath.advance({sys, forces, method}, h, s).converged());
    const Vectors& u = bath.half_jump();
    EXPECT_GT(u.norm(), 0.1);
    for (const auto& [i, j, d] : sys.bonds)
      EXPECT_NEAR((s.x.col(j) - s.x.col(i)).dot(u.col(j) - u.col(i)), 0, 1e-11);
  }
}

// In units of kT a rigid water's energy has P(x) = ½x²e⁻ˣ: six degrees of freedom. Ten bins as likely, 9
// degrees of freedom of χ², which one run in a thousand brings above 27.9.
double chi_square(const std::vector<double>& energies) {
  const auto below = [](double x) { return 1 - std::exp(-x) * (1 + x + x * x / 2); };
  std::array<double, 10> counts{};
  for (const double x : energies) ++counts[std::min(9, static_cast<int>(10 * below(x)))];
  const double expected = static_cast<double>(energies.size()) / 10;
  double sum = 0;
  for (const double n : counts) sum += (n - expected) * (n - expected) / expected;
  return sum;
}

TYPED_TEST(LangevinWith, FreeWatersHaveTheCanonicalKineticEnergies) {
  const double h = 1e-3, friction = 20, temperature = 298.15;
  auto [sys, s] = tests::waters(100, 5, 100);  // too cold a start
  tests::NoForce forces;
  auto method = with_defaults<TypeParam>(sys, h);
  Langevin bath(sys, {.temperature = temperature, .friction = friction, .seed = 11}, h);
  initialize(bath, {sys, forces, method}, h, s);
  std::vector<double> energies;
  double translation = 0, total = 0;
  for (int n = 1; n <= 6000; ++n) {
    ASSERT_TRUE(bath.advance({sys, forces, method}, h, s).converged());
    if (n <= 300 || n % 150 != 0) continue;  // e⁻³ of the last sample is left
    const Vectors v = DriftVelocity(sys).of(h, s);
    for (int w = 0; w < 100; ++w) {
      double kinetic = 0;
      for (int a = 3 * w; a < 3 * w + 3; ++a) kinetic += 0.5 * sys.mass[a] * v.col(a).squaredNorm();
      energies.push_back(kinetic / (kBoltzmann * temperature));
      const Vec3 p = v.middleCols<3>(3 * w) * sys.mass.segment<3>(3 * w);
      translation += 0.5 * p.squaredNorm() / sys.mass.segment<3>(3 * w).sum() / (kBoltzmann * temperature);
      total += energies.back();
    }
  }
  EXPECT_LT(chi_square(energies), 27.9);
  const double count = static_cast<double>(energies.size()), error = std::sqrt(1.5 / count);
  EXPECT_NEAR(translation / count, 1.5, 4 * error);
  EXPECT_NEAR((total - translation) / count, 1.5, 4 * error);
}

// The velocity temperatures are taken of has no part along the bonds, and is P(v + (h/2)M⁻¹f).
TYPED_TEST(LangevinWith, MiddleVelocityIsTangent) {
  const double h = 0.02;
  auto [sys, s] = tests::free_chain(10, 3);
  tests::UniformForce forces{{1, 2, 3}};
  auto method = with_defaults<TypeParam>(sys, h);
  Langevin bath(sys, {.temperature = kWarm, .friction = 5}, h);
  initialize(bath, {sys, forces, method}, h, s);
  for (int n = 0; n < 5; ++n) EXPECT_TRUE(bath.advance({sys, forces, method}, h, s).converged());
  const Vectors u = DriftVelocity(sys).of(h, s);
  Vectors want = s.v;
  for (int a = 0; a < sys.atoms(); ++a) want.col(a) += 0.5 * h * sys.inv_mass[a] * s.f.col(a);
  Projector(sys).velocities(sys, s.x, want);
  EXPECT_LT((u - want).norm(), 1e-12 * want.norm());
}

// A start knows of no jump before it: the velocity stays, and f holds the constraint forces alone.
TYPED_TEST(LangevinWith, StartsAnewWithoutAPast) {
  const double h = 0.01;
  auto [sys, s] = tests::free_chain(10, 3);
  tests::NoForce forces;
  auto method = with_defaults<TypeParam>(sys, h);
  Langevin bath(sys, {.temperature = kWarm, .friction = 5}, h);
  initialize(bath, {sys, forces, method}, h, s);
  for (int n = 0; n < 5; ++n) EXPECT_TRUE(bath.advance({sys, forces, method}, h, s).converged());
  initialize(bath, {sys, forces, method}, h, s);
  const Vectors v = s.v;
  initialize(bath, {sys, forces, method}, h, s);
  EXPECT_LT((s.v - v).norm(), 1e-12 * v.norm());
}

// Friction alone (0 K): a free particle slows as exp(−γt), from the first step on.
TEST(LangevinBath, FrictionSlowsAFreeParticle) {
  const double h = 0.05, friction = 3;
  const System sys = make_system(Eigen::VectorXd::Constant(1, 2.0), {});
  State s;
  s.x = s.f = Vectors::Zero(3, 1);
  s.v = Vectors::Ones(3, 1);
  tests::NoForce forces;
  Newton method(sys, {}, h);
  Langevin bath(sys, {.temperature = 0, .friction = friction}, h);
  initialize(bath, {sys, forces, method}, h, s);
  for (int n = 1; n <= 10; ++n) {
    EXPECT_TRUE(bath.advance({sys, forces, method}, h, s).converged());
    EXPECT_NEAR(s.v(0, 0), std::exp(-friction * h * n), 1e-12) << n;
  }
}

struct Springs : ForceLaw {
  explicit Springs(double its_k) : k(its_k) {}
  double k;
  void evaluate(const System&, State& s) override { s.f = -k * s.x; }
};

// The middle scheme is exact for springs: positions at any ωh, and the velocity that the bath acts on.
TEST(LangevinMiddle, IsExactForAHarmonicOscillatorAtALargeStep) {
  constexpr int kAtoms = 200;
  const System sys = make_system(Eigen::VectorXd::Constant(kAtoms, 2.0), {});
  const double h = 1, k = 2;  // ωh = 1: the velocity at full steps is a quarter too cold
  State s;
  s.x = s.v = Vectors::Zero(3, kAtoms);
  Springs springs{k};
  Newton method(sys, {}, h);
  Langevin bath(sys, {.temperature = kWarm, .friction = 0.7, .seed = 2}, h);
  initialize(bath, {sys, springs, method}, h, s);
  double x2 = 0, middle2 = 0, full2 = 0, samples = 0;
  for (int n = 1; n <= 2000; ++n) {
    EXPECT_TRUE(bath.advance({sys, springs, method}, h, s).converged());
    if (n < 20) continue;
    x2 += s.x.squaredNorm();
    full2 += s.v.squaredNorm();
    middle2 += DriftVelocity(sys).of(h, s).squaredNorm();
    samples += 3 * kAtoms;
  }
  EXPECT_NEAR(x2 / samples * k, 1, 0.01);
  EXPECT_NEAR(middle2 / samples * 2, 1, 0.01);
  EXPECT_NEAR(full2 / samples * 2, 0.75, 0.01);
}

// Of 20 free waters in a bath at 300 K, over 2 ps.
struct BathedWaters {
  explicit BathedWaters(double friction)
      : bath(start.system, {.temperature = 300, .friction = friction, .seed = 3}, h) {}
  double rms_error(ConstraintMethod& method) {
    auto& [sys, s] = start;
    initialize(bath, {sys, forces, method}, h, s);
    double sum = 0;
    for (int n = 0; n < 2000; ++n) {
      EXPECT_TRUE(bath.advance({sys, forces, method}, h, s).converged());
      sum += std::pow(bond_errors(sys, s.x).rms, 2);
    }
    return std::sqrt(sum / 2000);
  }
  static constexpr double h = 1e-3;
  tests::Start start = tests::waters(20, 5, 300);
  tests::NoForce forces;
  Langevin bath;
};

template <class Method>
double rms_error(double friction, const typename Method::Options& options = {}) {
  BathedWaters waters(friction);
  Method method(waters.start.system, options, waters.h);
  return waters.rms_error(method);
}

// The noise is known when λ is sought: it raises the floor of Baumgarte as a force of its size would, no
// more, and what feedforward's extrapolation misses. Told of half of it only, both are off by 1e-5.
TEST(LangevinFloor, NoiseIsNoSurprise) {
  const Baumgarte::Options centred{.damping = "centred"};
  const double quiet = rms_error<Baumgarte>(0, centred);
  EXPECT_LT(rms_error<Baumgarte>(1, centred), 3 * quiet);
  EXPECT_LT(rms_error<Baumgarte>(1), 2 * quiet);
  EXPECT_LT(rms_error<Baumgarte>(1, Feedforward::Options{}), 2e-8);
  EXPECT_LT(rms_error<Newton>(1), 1e-10);
}

// A method that is not told of the noise.
template <class Method>
struct Untold : ConstraintMethod {
  Untold(BathedWaters& waters, const typename Method::Options& options)
      : method(waters.start.system, options, waters.h) {}
  SolveStats add_forces(const System& sys, const Push& push, State& s) override {
    return method.add_forces(sys, {push.h, push.kick}, s);
  }
  const Eigen::VectorXd& lambda() const override { return method.lambda(); }
  Method method;
};

template <class Method>
double untold_rms_error(double friction, const typename Method::Options& options = {}) {
  BathedWaters waters(friction);
  Untold<Method> method(waters, options);
  return waters.rms_error(method);
}

TEST(LangevinFloor, IsHighWhereNobodyIsTold) {
  EXPECT_NEAR(untold_rms_error<Baumgarte>(1, {.damping = "centred"}) / 2.4e-5, 1, 0.2);
  EXPECT_NEAR(untold_rms_error<Baumgarte>(1, Feedforward::Options{}) / 1.4e-5, 1, 0.2);
}

// One solve a step.
TEST(LangevinFloor, OfStrongNoiseIsLowerWithoutExtrapolation) {
  EXPECT_NEAR(rms_error<Baumgarte>(10, Feedforward::Options{.tolerance = 1e-5}) / 2.7e-8, 1, 0.2);
  EXPECT_NEAR(rms_error<Baumgarte>(10, Feedforward::Options{.tolerance = 1e-5, .extrapolation = 0}) / 8.1e-9,
              1, 0.2);
}

TEST(LangevinBath, RepeatsBitForBitAndItsSeedMatters) {
  const auto end = [](std::uint64_t seed) {
    auto [sys, s] = tests::free_chain(8, 1);
    tests::NoForce forces;
    Newton method(sys, {}, 0.01);
    Langevin bath(sys, {.temperature = kWarm, .friction = 1, .seed = seed}, 0.01);
    initialize(bath, {sys, forces, method}, 0.01, s);
    for (int n = 0; n < 20; ++n) EXPECT_TRUE(bath.advance({sys, forces, method}, 0.01, s).converged());
    return s.x;
  };
  EXPECT_EQ(end(1), end(1));
  EXPECT_NE(end(1), end(2));
}

TEST(LangevinBath, HoldsTheMomentumWhereAsked) {
  const double h = 0.01;
  auto [sys, s] = tests::free_chain(8, 1);
  remove_momentum(sys, s.v);
  tests::NoForce forces;
  Newton method(sys, {}, h);
  Langevin bath(sys, {.temperature = kWarm, .friction = 5, .hold_momentum = true}, h);
  initialize(bath, {sys, forces, method}, h, s);
  for (int n = 0; n < 100; ++n) EXPECT_TRUE(bath.advance({sys, forces, method}, h, s).converged());
  EXPECT_LT(momentum(sys, s.v).norm(), 1e-11);
}

// The kernel draws what base/random.hpp's Philox and the C++ library's functions give, and the same bits on
// every machine and at every number of threads.
TEST(Noise, IsBoxMullerOfPhilox) {
  constexpr std::uint64_t kSeed = 0x123456789abcdef0, kStep = (std::uint64_t{1} << 32) + 5;
  Aligned<double> wanted(200 * kNoiseBlock), noise(wanted.size());
  fill_with_noise(kSeed, kStep, wanted);
  for (std::uint32_t n = 0; n < wanted.size() / 4; ++n) {
    const auto words =
        philox({n, static_cast<std::uint32_t>(Stream::kLangevin), 5, 1}, {0x9abcdef0, 0x12345678});
    for (int pair = 0; pair < 2; ++pair) {
      const double u = (2.0 * words[2 * pair] + 1) * 0x1p-33, radius = std::sqrt(-2 * std::log(u));
      const std::uint32_t angle = words[2 * pair + 1];
      const double t = ((angle & 0x3FFFFFFF) + 0.5) * 0x1p-30 * std::numbers::pi / 2;
      const double x = radius * std::cos(t), y = radius * std::sin(t);
      EXPECT_NEAR(wanted[4 * n + 2 * pair], angle >> 31 ? -x : x, 1e-12);
      EXPECT_NEAR(wanted[4 * n + 2 * pair + 1], angle >> 30 & 1 ? -y : y, 1e-12);
    }
  }
  tests::on_every_machine([&] {
    tests::on_one_to_three_threads([&] {
      std::ranges::fill(noise, 0);
      fill_with_noise(kSeed, kStep, noise);
      EXPECT_EQ(noise, wanted);
    });
  });
}

// A million numbers: a moment of variance s² is met within 5 s/1000. Neighbours are independent, and so are a
// step and the next.
TEST(Noise, HasTheMomentsOfIndependentNormalNumbers) {
  constexpr std::size_t kMany = 1 << 20;
  Aligned<double> now(kMany), next(kMany);
  fill_with_noise(3, 0, now);
  fill_with_noise(3, 1, next);
  std::array<double, 4> moments{};
  double neighbours = 0, steps = 0, squares = 0;
  for (std::size_t n = 0; n < kMany; ++n) {
    for (int m = 0; m < 4; ++m) moments[m] += std::pow(now[n], m + 1) / kMany;
    neighbours += now[n] * now[(n + 1) % kMany] / kMany;
    steps += now[n] * next[n] / kMany;
    squares += (now[n] * now[n] - 1) * (now[(n + 1) % kMany] * now[(n + 1) % kMany] - 1) / kMany;
  }
  EXPECT_NEAR(moments[0], 0, 0.005);
  EXPECT_NEAR(moments[1], 1, 0.0071);
  EXPECT_NEAR(moments[2], 0, 0.02);
  EXPECT_NEAR(moments[3], 3, 0.05);
  EXPECT_NEAR(neighbours, 0, 0.005);
  EXPECT_NEAR(steps, 0, 0.005);
  EXPECT_NEAR(squares, 0, 0.01);
}

}  // namespace
}  // namespace taut::langevin_tests
