// Struts and ropes: who holds them, that they act where they touch and nowhere else, and make no energy.

#include <gtest/gtest.h>

#include <cmath>

#include "constraints/bond_algebra.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "constraints/methods/rattle.hpp"
#include "constraints/methods/shake.hpp"
#include "constraints/projection.hpp"
#include "constraints/registry.hpp"
#include "error_message.hpp"
#include "free_system.hpp"
#include "md/observables.hpp"

namespace taut::one_sided_tests {
namespace {

using tests::NoForce;
using tests::Start;
using tests::UniformForce;

struct Holder {
  const char* name;
  MethodOptions options;
  double passed;  // by how much of its length a bond may be passed
};
void PrintTo(const Holder& holder, std::ostream* out) {
  *out << holder.name;
}
std::vector<Holder> holders() {
  return {
      {"rattle", Rattle::Options{{.tolerance = 1e-12}}, 1.1e-12},
      {"rattle_cold", Rattle::Options{{.tolerance = 1e-12}, false}, 1.1e-12},
      {"shake", Shake::Options{{.tolerance = 1e-12}}, 1.1e-12},
      {"baumgarte", Baumgarte::Options{.tolerance = 1e-12}, 1e-4},
      {"baumgarte_swept", Baumgarte::Options{.gains = "dead-beat", .sweeps = 60, .extrapolation = 0}, 1e-4}};
}
class OneSided : public ::testing::TestWithParam<Holder> {};
INSTANTIATE_TEST_SUITE_P(By, OneSided, ::testing::ValuesIn(holders()),
                         [](const auto& test) { return test.param.name; });

// A ball of 1 u at the end of a rope or strut of 1 nm from an anchor.
Start ball(Side side, const Vec3& x, const Vec3& v) {
  Start start;
  start.system = make_system(Eigen::Vector2d(0, 1), {}, {}, {{{0, 1, 1.0}, side}});
  start.state.x = start.state.v = start.state.f = Vectors::Zero(3, 2);
  start.state.x.col(1) = x;
  start.state.v.col(1) = v;
  return start;
}

constexpr double kG = 9.81;  // [nm/ps²]

// Thrown up inside its rope: a parabola, to rounding, until the rope is reached; then a touch that takes the
// velocity along the rope, and a pendulum with the energy that is left.
TEST_P(OneSided, ABallOnARopeFliesFreelyUntilItIsTaut) {
  const Vec3 x0(0.3, -0.2, 0), v0(2, 3, 0);
  Start start = ball(Side::kAtMost, x0, v0);
  State& s = start.state;
  UniformForce gravity(Vec3(0, -kG, 0));
  const double h = 1e-4;
  const auto method = make_method(start.system, GetParam().options, h);
  const Dynamics dynamics{start.system, gravity, *method};
  initialize(dynamics, h, s);
  int n = 0;
  while (method->lambda()[0] == 0 && n < 10000) {
    ASSERT_TRUE(step(dynamics, h, s).converged());
    ++n;
    const Vec3 parabola = x0 + s.t * v0 + 0.5 * s.t * s.t * Vec3(0, -kG, 0);
    if (method->lambda()[0] != 0) break;
    ASSERT_LT((s.x.col(1) - parabola).norm(), 1e-12);
  }
  // Where |x₀ + v₀t + ½gt²| = 1, by bisection.
  double before = 0, after = 0.5;
  const auto path = [&](double t) { return Vec3(x0 + t * v0 + 0.5 * t * t * Vec3(0, -kG, 0)); };
  while (after - before > 1e-12) {
    const double t = 0.5 * (before + after);
    (path(t).norm() < 1 ? before : after) = t;
  }
  EXPECT_NEAR(s.t, after, 1.01 * h);
  const Vec3 at = path(after), v = v0 + after * Vec3(0, -kG, 0);
  const double left = 0.5 * (v - at.dot(v) * at).squaredNorm() + kG * at.y();
  for (int more = 0; more < 5000; ++more) {
    ASSERT_TRUE(step(dynamics, h, s).converged());
    ASSERT_LT(s.x.col(1).norm(), 1 + GetParam().passed);
    ASSERT_LE(method->lambda()[0], 0);  // it pulls
    if (more == 2) {
      EXPECT_NEAR(0.5 * s.v.col(1).squaredNorm() + kG * s.x(1, 1), left, 1e-3);
    }
  }
  EXPECT_LT(method->lambda()[0], 0);
}

// Swung from below with v² between 2gR and 5gR the ball leaves the circle where gravity alone turns it:
// sin φ = (v² − 2gR)/(3gR) above the horizontal, R v² of there = g sin φ.
TEST_P(OneSided, ARopeGoesSlackWhereGravityAloneTurnsTheBall) {
  const double v = std::sqrt(3.5 * kG), h = 1e-4;
  Start start = ball(Side::kAtMost, {0, -1, 0}, {v, 0, 0});
  State& s = start.state;
  UniformForce gravity(Vec3(0, -kG, 0));
  const auto method = make_method(start.system, GetParam().options, h);
  const Dynamics dynamics{start.system, gravity, *method};
  initialize(dynamics, h, s);
  EXPECT_NEAR(-method->lambda()[0], kG + v * v, GetParam().options.get_if<Baumgarte::Options>() ? 0.1 : 45);
  for (int n = 0; n < 4; ++n) ASSERT_TRUE(step(dynamics, h, s).converged());
  EXPECT_NEAR(-method->lambda()[0], kG + v * v, 0.1);
  while (method->lambda()[0] < 0 && s.t < 2) ASSERT_TRUE(step(dynamics, h, s).converged());
  EXPECT_NEAR(s.x(1, 1), 0.5, 2e-3);
  EXPECT_GT(s.x(0, 1), 0);
  for (int n = 0; n < 500; ++n) {
    ASSERT_TRUE(step(dynamics, h, s).converged());
    ASSERT_EQ(method->lambda()[0], 0);
  }
  EXPECT_LT(s.x.col(1).norm(), 0.999);  // inside
}

// Balls let fall on each other above an anchor come to rest a length apart, and each strut bears what is
// above it.
TEST_P(OneSided, AStackBearsItsWeight) {
  constexpr int kBalls = 5;
  Eigen::VectorXd mass(kBalls + 1);
  mass << 0, 1, 2, 0.5, 4, 1;
  std::vector<OneSidedBond> struts;
  Start start;
  start.state.x = start.state.v = start.state.f = Vectors::Zero(3, kBalls + 1);
  for (int b = 1; b <= kBalls; ++b) {
    struts.push_back({{b - 1, b, 0.1 * b}, Side::kAtLeast});
    start.state.x(1, b) = start.state.x(1, b - 1) + 0.1 * b + 0.03 * (b % 3);
  }
  start.system = make_system(mass, {}, {}, struts);
  State& s = start.state;
  UniformForce gravity(Vec3(0, -kG, 0));
  const double h = 1e-3;
  const auto method = make_method(start.system, GetParam().options, h);
  const Dynamics dynamics{start.system, gravity, *method};
  initialize(dynamics, h, s);
  for (int n = 0; n < 2000; ++n) {
    ASSERT_TRUE(step(dynamics, h, s).converged());
    ASSERT_LT(bond_errors(start.system, s.x).max, std::max(GetParam().passed, 1e-10));
    ASSERT_GE(method->lambda().minCoeff(), 0);
  }
  double above = 0;
  for (int b = kBalls; b >= 1; --b) {
    above += mass[b] * kG;
    EXPECT_NEAR((s.x.col(b) - s.x.col(b - 1)).norm(), 0.1 * b, 1e-6);
    EXPECT_NEAR(method->lambda()[b - 1] * 0.1 * b, above, 1e-3 * above) << b;
  }
}

// Six balls, two of them on rods, tied to an anchor by ropes and kept apart by struts: touches all the time.
Start cage(std::uint64_t seed) {
  constexpr int kBalls = 8;
  Random random(seed);
  Start start;
  State& s = start.state;
  s.x = s.v = s.f = Vectors::Zero(3, kBalls + 1);
  Eigen::VectorXd mass = Eigen::VectorXd::Ones(kBalls + 1);
  mass[0] = 0;
  std::vector<RigidBond> rods;
  std::vector<OneSidedBond> sided;
  for (int b = 1; b <= kBalls; ++b) {
    s.x.col(b) << (b & 1 ? 1 : -1), (b & 2 ? 1 : -1), (b & 4 ? 1 : -1);
    s.x.col(b) *= 0.5;
    s.x.col(b) += 0.05 * random.normal_vector();
    s.v.col(b) = 3 * random.normal_vector();
    mass[b] = 1 + b % 3;
    sided.push_back({{0, b, 1.3}, Side::kAtMost});
  }
  for (const auto& [a, b] : {std::pair(1, 2), std::pair(2, 3)})
    rods.push_back({a, b, (s.x.col(a) - s.x.col(b)).norm()});
  for (int a = 1; a <= kBalls; ++a)
    for (int b = a + 1; b <= kBalls; ++b)
      if (!(b == a + 1 && a < 3)) sided.push_back({{a, b, 0.6}, Side::kAtLeast});
  start.system = make_system(mass, rods, {}, sided);
  return start;
}

// s σ ≥ 0, s λ ≥ 0, and what acts touches; no step makes energy: of the half-step velocities, with which
// shake and Baumgarte end a touch one step after it began.
TEST_P(OneSided, ActsOnlyWhereItTouchesAndMakesNoEnergy) {
  const double h = 2e-3;
  int touches = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Start start = cage(seed);
    State& s = start.state;
    const System& sys = start.system;
    NoForce none;
    const auto method = make_method(sys, GetParam().options, h);
    const Dynamics dynamics{sys, none, *method};
    initialize(dynamics, h, s);
    const bool velocities = GetParam().name[0] != 's' && GetParam().name[0] != 'b';
    const double first = kinetic_energy(sys, s.v);
    double energy = first;
    for (int n = 0; n < 1500; ++n) {
      const Vectors x = s.x;
      const Eigen::VectorXd lambda = method->lambda();
      ASSERT_TRUE(step(dynamics, h, s).converged());
      ASSERT_LT(bond_errors(sys, s.x).max, GetParam().passed) << n;
      const double now = kinetic_energy(sys, velocities ? s.v : Vectors((s.x - x) / h));
      if (n > 0) {
        ASSERT_LT(now, energy * (1 + 1e-5) + 1e-9 * first) << n;
      }
      energy = now;
      const bool forces = GetParam().name[0] == 'b';  // their λ is of the step to come
      const Eigen::VectorXd& acted = forces ? lambda : method->lambda();
      for (int k = sys.bond_count(); k < sys.all_bonds(); ++k) {
        const auto& [i, j, d] = sys.bond(k);
        ASSERT_GE(sys.side(k) * acted[k], 0);
        if (acted[k] == 0 || (forces && n < 2)) continue;
        ++touches;
        ASSERT_NEAR((s.x.col(j) - s.x.col(i)).norm(), d, std::max(GetParam().passed, 1e-10) * d) << n;
      }
    }
    EXPECT_LT(energy, 0.9 * first);
  }
  EXPECT_GT(touches, 100);
}

// A bond alone, whatever it comes from and goes to: RATTLE's step makes no energy (constraints/README.md).
TEST(OneSidedBonds, ATouchNeverMakesEnergy) {
  Random random(3);
  NoForce none;
  const double h = 0.01;
  int touches = 0;
  for (int n = 0; n < 20000; ++n) {
    const Side side = n % 2 ? Side::kAtLeast : Side::kAtMost;
    const double far = random.uniform();
    Start start = ball(side, (side == Side::kAtLeast ? 1 + 0.1 * far : far) * random.unit_vector(),
                       30 * random.normal_vector());
    const auto method = make_method(start.system, Rattle::Options{{.tolerance = 1e-13}}, h);
    const double before = start.state.v.squaredNorm();
    const SolveStats stats = step({start.system, none, *method}, h, start.state);
    if (!stats.converged()) continue;  // turned by 90°
    ASSERT_LE(start.state.v.squaredNorm(), before * (1 + 1e-11)) << n;
    touches += method->lambda()[0] != 0;
  }
  EXPECT_GT(touches, 1000);
}

// Without correction a strut has σ̈ ≥ 0 alone: the ball keeps the speed it came with, and passes through.
// Near the anchor a slack rope turns by more than 90° in a step.
TEST_P(OneSided, ASlackRopeWhoseEndsPassEachOtherDoesNotPull) {
  Start start = ball(Side::kAtMost, Vec3(0.05, 0.01, 0), Vec3(-100, 0, 0));
  State& s = start.state;
  NoForce none;
  const double h = 1e-3;
  const auto method = make_method(start.system, GetParam().options, h);
  const Dynamics dynamics{start.system, none, *method};
  initialize(dynamics, h, s);
  for (int n = 0; n < 5; ++n) ASSERT_TRUE(step(dynamics, h, s).converged());
  EXPECT_DOUBLE_EQ(kinetic_energy(start.system, s.v), 5000);
}

TEST(OneSidedBonds, WithoutCorrectionABallPassesThrough) {
  const double h = 1e-3, speed = 2;
  const auto least = [&](const char* method) {
    Start start = ball(Side::kAtLeast, {1.0005 * speed * h + 1, 0, 0}, {-speed, 0, 0});
    NoForce none;
    const auto made = make_method(start.system, default_options(method), h);
    const Dynamics dynamics{start.system, none, *made};
    initialize(dynamics, h, start.state);
    double nearest = 2;
    for (int n = 0; n < 101; ++n) {
      EXPECT_TRUE(step(dynamics, h, start.state).converged());
      nearest = std::min(nearest, start.state.x.col(1).norm());
    }
    return nearest;
  };
  EXPECT_NEAR(least("none"), 1 - 100 * speed * h, 2 * speed * h);
  EXPECT_GT(least("baumgarte"), 1 - 1e-9);
  EXPECT_GT(least("rattle"), 1 - 1e-9);
}

// And leaves alone what is slack.
TEST(OneSidedBonds, WithoutCorrectionASlackRopeLetsFly) {
  Start start = ball(Side::kAtMost, {0.1, 0, 0}, {1, 2, 3});
  NoForce none;
  const auto method = make_method(start.system, default_options("none"), 1e-3);
  const Dynamics dynamics{start.system, none, *method};
  initialize(dynamics, 1e-3, start.state);
  for (int n = 0; n < 100; ++n) ASSERT_TRUE(step(dynamics, 1e-3, start.state).converged());
  EXPECT_LT((start.state.x.col(1) - Vec3(0.2, 0.2, 0.3)).norm(), 1e-12);
}

// Those that never touch change nothing.
TEST(OneSidedBonds, SlackOnesChangeNothing) {
  const double h = 2e-3;
  for (const auto& [name, options, passed] : holders()) {
    const Start start = tests::free_chain(6, 8);
    System slack = start.system;
    for (int a = 0; a < 4; ++a) {
      slack.one_sided.push_back({{a, a + 2, 1e-3}, Side::kAtLeast});
      slack.one_sided.push_back({{a, a + 2, 10}, Side::kAtMost});
    }
    const auto end = [&](const System& sys, std::unique_ptr<ConstraintMethod> method) {
      State s = start.state;
      NoForce none;
      const Dynamics dynamics{sys, none, *method};
      initialize(dynamics, h, s);
      for (int n = 0; n < 100; ++n) EXPECT_TRUE(step(dynamics, h, s).converged());
      return s.x;
    };
    MethodOptions same = options;
    if (const auto* baumgarte = options.get_if<Baumgarte::Options>()) {
      Baumgarte::Options exact = *baumgarte;
      exact.tolerance = 1e-13;
      same = exact;
    }
    const Vectors without = end(start.system, make_plain(start.system, same, h));
    EXPECT_LT((end(slack, make_method(slack, same, h)) - without).cwiseAbs().maxCoeff(), 1e-11) << name;
  }
}

TEST(OneSidedBonds, WhoDoesNotHoldThemSaysSo) {
  const Start start = ball(Side::kAtMost, {0.5, 0, 0}, Vec3::Zero());
  for (const MethodEntry& method : methods()) {
    const std::string words =
        error_message([&] { make_method(start.system, default_options(method.name), 1e-3); });
    const std::string refusal = "method \"" + std::string(method.name) +
                                "\" holds no one-sided bonds (at_least, at_most), and there are 1: expected "
                                "none, baumgarte, shake, rattle";
    EXPECT_EQ(words, method.one_sided ? "no error" : refusal);
  }
}

TEST(OneSidedBonds, AreChecked) {
  const auto refusal = [](std::vector<RigidBond> bonds, std::vector<OneSidedBond> one_sided) -> std::string {
    return error_message(
        [&] { make_system(Eigen::Vector3d(0, 1, 0), std::move(bonds), {}, std::move(one_sided)); });
  };
  EXPECT_EQ(refusal({}, {{{0, 1, 1}, Side::kAtLeast}, {{1, 0, 2}, Side::kAtMost}}), "no error");
  EXPECT_EQ(refusal({}, {{{0, 1, 1}, Side::kAtMost}, {{1, 0, 2}, Side::kAtMost}}),
            "one-sided bond 1 (1-0): repeats one-sided bond 0, two bonds on the same pair");
  EXPECT_EQ(refusal({{0, 1, 1}}, {{{0, 1, 1}, Side::kAtMost}}),
            "one-sided bond 0 (0-1): repeats bond 0, two bonds on the same pair");
  EXPECT_EQ(refusal({}, {{{0, 3, 1}, Side::kAtMost}}),
            "one-sided bond 0: atom 3 is out of range, the system has atoms 0 to 2");
  EXPECT_EQ(refusal({}, {{{0, 2, 1}, Side::kAtLeast}}),
            "one-sided bond 0 (0-2): both ends are anchored (mass 0)");
  EXPECT_EQ(refusal({}, {{{0, 1, 0}, Side::kAtLeast}}),
            "one-sided bond 0 (0-1): length 0 nm, expected more than 0");
}

}  // namespace
}  // namespace taut::one_sided_tests
