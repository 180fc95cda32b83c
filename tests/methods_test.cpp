// What holds of every method of the list.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "constraints/batch/batched_baumgarte.hpp"
#include "constraints/batch/batched_lincs.hpp"
#include "constraints/batch/batched_newton.hpp"
#include "constraints/batch/batched_sweeps.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "constraints/methods/mshake.hpp"
#include "constraints/methods/penalty.hpp"
#include "constraints/methods/settle.hpp"
#include "constraints/registry.hpp"
#include "error_message.hpp"
#include "free_system.hpp"
#include "verifier.hpp"

namespace taut::methods_tests {
namespace {

using tests::NoForce;
using tests::Start;
using tests::tight;
using tests::Verdict;
using tests::verify;

// A closed ring of unit bonds, puckered.
Start ring(int beads, std::uint64_t seed) {
  Start start = tests::free_chain(beads, seed);
  const double radius = 0.5 / std::sin(M_PI / beads);
  for (int i = 0; i < beads; ++i) {
    const double phi = 2 * M_PI * i / beads;
    start.state.x.col(i) << radius * std::cos(phi), radius * std::sin(phi), 0.1 * (i % 2);
  }
  auto bonds = start.system.bonds;
  bonds.push_back({beads - 1, 0, 1.0});
  start.system = make_system(start.system.mass, bonds);
  return start;
}

// A bead with three arms of two, masses 1 : 20.
Start tree() {
  Start start = tests::free_chain(7, 5);
  Eigen::VectorXd mass(7);
  mass << 20, 1, 1, 1, 1, 1, 1;
  start.state.x << 0, 1, 1.7, -0.5, -1.2, -0.5, -1.1,  //
      0, 0, 0.7, 0.87, 1.5, -0.87, -0.9,               //
      0, 0, 0.1, 0, 0.3, 0, 0.8;
  start.system = make_system(mass, {{0, 1, 1}, {1, 2, 1}, {0, 3, 1}, {3, 4, 1}, {5, 0, 1}, {5, 6, 1}});
  return start;
}

Start anchored_chain() {
  Start start = tests::free_chain(5, 21);
  Eigen::VectorXd mass = start.system.mass;
  mass[0] = 0;
  start.state.v.col(0).setZero();
  start.system = make_system(mass, start.system.bonds);
  return start;
}

struct Case {
  const char* name;
  Start start;
  double h;
};

std::vector<Case> cases() {
  return {{"rotor", tests::rotor(3), 0.01},
          {"chain of 20", tests::free_chain(20, 1), 0.01},
          {"ring of 8", ring(8, 2), 0.01},
          {"tree", tree(), 0.01},
          {"waters", tests::waters(4, 3, 300), 0.001},
          {"anchored chain", anchored_chain(), 0.01}};
}

class EveryMethod : public ::testing::TestWithParam<std::string_view> {};

TEST_P(EveryMethod, HoldsEveryShapeAsItPromises) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    if (GetParam() == "settle" && std::string_view(c.name) != "waters") {
      EXPECT_THROW(make_method(c.start.system, Settle::Options{}, c.h), InputError);
      continue;
    }
    NoForce forces;
    const MethodOptions options = default_options(GetParam());
    const Verdict verdict = verify(c.start.system, forces, options, c.h, 500, c.start.state);
    ASSERT_TRUE(verdict.stats.converged()) << in_words(verdict.stats.failure);
    const double promise = make_method(c.start.system, options, c.h)->promised_error();
    EXPECT_LE(verdict.bond_error, promise * (1 + 1e-3) + 1e-15);
    // Methods that promise no number are held to what a step's truncation feeds them.
    if (GetParam() == "baumgarte") {
      EXPECT_LT(verdict.bond_error, 20 * verdict.predicted_error);
    }
    if (GetParam() == "none") {
      EXPECT_LT(verdict.bond_error, 500 * 500 * verdict.predicted_error);
    }
    if (GetParam() == "penalty") {
      EXPECT_LT(verdict.bond_error, 0.1);
    }
    if (GetParam() == "lincs") {
      EXPECT_LT(verdict.bond_error, 0.01);
    }
    EXPECT_GT(verdict.turn, 0.9);
    const bool free = (c.start.system.mass.array() > 0).all();
    if (free) {
      EXPECT_LT(verdict.momentum_change, 1e-13);
    }
    RecordProperty(std::string(c.name) + " relative change of the energy",
                   std::to_string(verdict.energy_change));
    if (GetParam() == "newton" || GetParam() == "rattle") {
      EXPECT_LT(verdict.energy_change, 2e-2);
    }
  }
}

// A molecule every method can hold: waters for settle, a chain for the others.
Start molecule_for(std::string_view method, std::uint64_t seed) {
  return method == "settle" ? tests::waters(3, seed, 300) : tests::free_chain(6, seed);
}

TEST_P(EveryMethod, GivesTheSameBitsTwice) {
  NoForce forces;
  const Start start = molecule_for(GetParam(), 4);
  const auto once = verify(start.system, forces, default_options(GetParam()), 0.001, 50, start.state);
  const auto again = verify(start.system, forces, default_options(GetParam()), 0.001, 50, start.state);
  EXPECT_EQ(once.end.x, again.end.x);
  EXPECT_EQ(once.end.v, again.end.v);
}

struct Turncoat : ForceLaw {  // no force, until it is no number
  int calls = 0;
  void evaluate(const System&, State& s) override { s.f.setConstant(++calls == 6 ? std::nan("") : 0.0); }
};

// The first residual that is no number stops a run: its bonds do not hold.
void expect_it_stops_before_NaN(const Start& start, ConstraintMethod& method) {
  Turncoat forces;
  State s = start.state;
  initialize({start.system, forces, method}, 1e-3, s);
  int n = 1;
  while (n < 100 && step({start.system, forces, method}, 1e-3, s).held()) ++n;
  EXPECT_LE(n, 6);
}

TEST_P(EveryMethod, StopsBeforeNaN) {
  const Start start = molecule_for(GetParam(), 4);
  for (const auto make : {make_method, make_plain}) {
    const auto method = make(start.system, default_options(GetParam()), 1e-3);
    expect_it_stops_before_NaN(start, *method);
  }
}

TEST(PlainMethods, StopBeforeNaNAfterSoManySweeps) {
  const Start start = tests::free_chain(6, 4);
  for (const MethodOptions& options :
       {MethodOptions(Baumgarte::Options{.sweeps = 3}), MethodOptions(Shake::Options{{.sweeps = 3}}),
        MethodOptions(Rattle::Options{{.sweeps = 3}})}) {
    const auto method = make_plain(start.system, options, 1e-3);
    expect_it_stops_before_NaN(start, *method);
  }
}

// The multipliers are those of J M⁻¹Jᵀλ = −(J M⁻¹F + |v_ij|²) up to the order of the step.
TEST_P(EveryMethod, ItsMultipliersAreTheExactOnesToFirstOrder) {
  if (GetParam() == "penalty") GTEST_SKIP() << "a spring swings about its multiplier";
  const Start start = molecule_for(GetParam(), 9);
  tests::UniformForce forces{Vec3(0, 0, -1)};
  const double h = GetParam() == "settle" ? 1e-4 : 1e-3;
  const auto verdict = verify(start.system, forces, default_options(GetParam()), h, 20, start.state);
  State end = verdict.end;
  forces.evaluate(start.system, end);
  Projector projector(start.system);
  if (GetParam() == "shake") projector.velocities(start.system, end.x, end.v);
  const Eigen::VectorXd exact = projector.multipliers(start.system, end);
  EXPECT_LT((verdict.lambda - exact).norm(), 1e-2 * exact.norm());
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod, ::testing::ValuesIn(method_names()),
                         [](const auto& test) { return std::string(test.param); });

struct OptionsOfNobody {
  std::vector<Option> describe() { return {}; }
};
struct OptionsOfTwo : OptionsOfNobody {};

MethodEntry entry_with(std::string_view name, const std::any& defaults) {
  const auto make = [](const System&, const std::any&, double) {
    return std::make_unique<ConstraintMethod>();
  };
  return {.name = name,
          .summary = "a test's",
          .defaults = defaults,
          .describe = [](std::any&) { return std::vector<Option>{}; },
          .make = make,
          .make_plain = make};
}

// Options say whose they are by their type alone.
TEST(MethodOptions, OfNoMethodOrOfTwoAreRefusedByName) {
  EXPECT_EQ(MethodOptions(Newton::Options{}).name(), "newton");
  EXPECT_EQ(error_message([] { MethodOptions{OptionsOfNobody{}}; }),
            "options of type taut::methods_tests::(anonymous namespace)::OptionsOfNobody: no method takes "
            "them; add "
            "yours with add_method() first, with these options as its defaults");
  add_method(entry_with("first of two", OptionsOfTwo{}));
  EXPECT_EQ(MethodOptions(OptionsOfTwo{}).name(), "first of two");
  add_method(entry_with("second of two", OptionsOfTwo{}));
  EXPECT_EQ(
      error_message([] { MethodOptions{OptionsOfTwo{}}; }),
      "options of type taut::methods_tests::(anonymous namespace)::OptionsOfTwo: both method \"first of "
      "two\" and "
      "method \"second of two\" take them, expected one; derive a type of its own for one of the two (struct "
      "Options : TheOthers {})");
}

// A start is brought to its bonds as exactly as numbers can say, not to a tolerance.
TEST(RattleAndNewton, AgreeToRoundOff) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    NoForce forces;
    const auto rattle = verify(c.start.system, forces, tight<Rattle::Options>(), c.h, 100, c.start.state);
    for (const MethodOptions& direct : {tight<Newton::Options>(), tight<MShake::Options>()}) {
      const auto newton = verify(c.start.system, forces, direct, c.h, 100, c.start.state);
      ASSERT_TRUE(rattle.stats.converged() && newton.stats.converged());
      EXPECT_LT((rattle.end.x - newton.end.x).cwiseAbs().maxCoeff(), 1e-10);
      EXPECT_LT((rattle.end.v - newton.end.v).cwiseAbs().maxCoeff(), 1e-9);
    }
  }
}

TEST(Projector, ReachesRoundOff) {
  Start start = tests::free_chain(20, 4);
  for (double far = 1e-2; far > 1e-9; far /= 3) {
    Vectors x = start.state.x + far * start.state.v;
    Projector(start.system).positions(start.system, x);
    EXPECT_LT(bond_errors(start.system, x).max, 2e-15) << far;
  }
}

// Far from the origin positions have fewer digits for a bond.
TEST(Projector, ReachesRoundOffFarAway) {
  Start start = tests::free_chain(20, 4);
  for (const double away : {1e3, 1e5, 1e7}) {
    Vectors x = (start.state.x + 1e-3 * start.state.v).array() + away;
    Projector(start.system).positions(start.system, x);
    EXPECT_LT(bond_errors(start.system, x).max, 1e-15 * away);
  }
}

// A straight chain of three with its 1–3 distance held as well: one bond too many.
TEST(Projector, NamesTheBondThatDependsOnOthers) {
  const System sys = make_system(Eigen::VectorXd::Ones(3), {{0, 1, 1}, {1, 2, 1}, {0, 2, 2}});
  Vectors x = Vectors::Zero(3, 3);
  x(0, 1) = 1.0;
  x(0, 2) = 2.0 + 1e-7;
  EXPECT_THAT(error_message<SimulationFailure>([&] { Projector(sys).positions(sys, x); }),
              testing::HasSubstr("depends on other bonds"));
}

// Turning by 3 rad a step: no first step can hold it.
TEST(Start, ThatAMethodCannotHoldIsAFailureThatNamesTheBond) {
  Start rotor = tests::rotor(300);
  Batched<Baumgarte> method(rotor.system, Feedforward::Options{}, 0.01);
  NoForce forces;
  EXPECT_THAT(error_message<SimulationFailure>([&] {
                initialize({rotor.system, forces, method}, 0.01, rotor.state);
              }),
              testing::HasSubstr("bond 0 (atoms 0-1)"));
}

TEST(Methods, LimitsAreRefusedByTheirOwnKeys) {
  const System sys = tests::rotor(1).system;
  const std::vector<std::pair<MethodOptions, const char*>> refused = {
      {Newton::Options{.tolerance = 1}, "tolerance: expected "},
      {Newton::Options{.max_iterations = 0}, "max_iterations: expected at least 1, got 0"},
      {Feedforward::Options{.max_solves = 0}, "max_solves: expected at least 1, got 0"},
      {Rattle::Options{{.tolerance = 0}}, "tolerance: expected "},
      {Rattle::Options{{.max_sweeps = 0}}, "max_sweeps: expected at least 1, got 0"},
      {Shake::Options{{.max_sweeps = 0}}, "max_sweeps: expected at least 1, got 0"},
      {Shake::Options{{.sweeps = -1}}, "sweeps: expected at least 0, got -1"},
      {Lincs::Options{.order = -1}, "order: expected at least 0, got -1"},
      {Lincs::Options{.iterations = -1}, "iterations: expected at least 0, got -1"},
      {Baumgarte::Options{.max_solves = 0}, "max_solves: expected at least 1, got 0"},
      {Baumgarte::Options{.sweeps = -1}, "sweeps: expected at least 0, got -1"},
      {Penalty::Options{.omega_h = 2.5}, "omega_h: expected "}};
  for (const auto& [options, words] : refused)
    EXPECT_THAT(error_message([&, &options = options] { make_method(sys, options, 0.01); }),
                testing::StartsWith(std::string("method.") + words));
  EXPECT_THROW(make_method(sys, Rattle::Options{}, 0), InputError);
}

// Where `key` goes.
template <class Options>
const void* field_of(Options& options, std::string_view key) {
  for (const Option& option : options.describe())
    if (option.key == key)
      return std::visit([](const auto* field) -> const void* { return field; }, option.field);
  return nullptr;
}

TEST(Methods, EveryKeySetsTheOptionOfItsName) {
  Shake::Options shake;
  EXPECT_EQ(field_of(shake, "tolerance"), &shake.tolerance);
  EXPECT_EQ(field_of(shake, "max_sweeps"), &shake.max_sweeps);
  EXPECT_EQ(field_of(shake, "sweeps"), &shake.sweeps);
  Rattle::Options rattle;
  EXPECT_EQ(field_of(rattle, "max_sweeps"), &rattle.max_sweeps);
  EXPECT_EQ(field_of(rattle, "sweeps"), &rattle.sweeps);
  Lincs::Options lincs;
  EXPECT_EQ(field_of(lincs, "order"), &lincs.order);
  EXPECT_EQ(field_of(lincs, "iterations"), &lincs.iterations);
  Feedforward::Options feedforward;
  EXPECT_EQ(field_of(feedforward, "extrapolation"), &feedforward.extrapolation);
  EXPECT_EQ(field_of(feedforward, "max_solves"), &feedforward.max_solves);
  Baumgarte::Options baumgarte;
  EXPECT_EQ(field_of(baumgarte, "gains"), &baumgarte.gains);
  EXPECT_EQ(field_of(baumgarte, "damping"), &baumgarte.damping);
  EXPECT_EQ(field_of(baumgarte, "alpha_per_ps"), &baumgarte.alpha_per_ps);
  EXPECT_EQ(field_of(baumgarte, "beta_per_ps"), &baumgarte.beta_per_ps);
  EXPECT_EQ(field_of(baumgarte, "reduction"), &baumgarte.reduction);
  EXPECT_EQ(field_of(baumgarte, "stiffness"), &baumgarte.stiffness);
  EXPECT_EQ(field_of(baumgarte, "tolerance"), &baumgarte.tolerance);
  EXPECT_EQ(field_of(baumgarte, "extrapolation"), &baumgarte.extrapolation);
  EXPECT_EQ(field_of(baumgarte, "max_solves"), &baumgarte.max_solves);
  EXPECT_EQ(field_of(baumgarte, "sweeps"), &baumgarte.sweeps);
}

TEST(Methods, UnknownNameIsRefusedWithTheNearest) {
  EXPECT_THAT(error_message([&] { default_options("ratle"); }),
              testing::HasSubstr("did you mean \"rattle\"?"));
}

}  // namespace
}  // namespace taut::methods_tests
