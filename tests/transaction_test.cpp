// Who watches a run may move atoms, and code from outside may throw anything anywhere: a run is the same to
// the last bit as one that was stopped there, or never disturbed.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/threads.hpp"
#include "constraints/registry.hpp"
#include "kept_state.hpp"
#include "named_scene.hpp"
#include "simulation/simulation.hpp"

namespace taut::transaction_tests {
namespace {

using Overrides = std::vector<std::string>;

struct Case {
  std::string method, bath, barostat;
  int threads = 1;

  Overrides settings() const {
    Overrides all = {"method.name=\"" + method + "\"", "build.molecules=216", "run.steps=60",
                     "run.log_every=15", "run.barostat_every=5"};
    if (barostat == "none") all.pop_back();
    if (method == "penalty") all.push_back("run.dt_fs=0.2");
    if (bath != "none") all.push_back("run.thermostat=\"" + bath + "\"");
    if (bath != "none") all.push_back("run.temperature_k=300");
    if (bath == "rescaling") all.push_back("run.thermostat_ps=0.1");
    if (barostat != "none") all.push_back("run.barostat=\"" + barostat + "\"");
    return all;
  }
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const char* method :
       {"rattle", "shake", "mshake", "lincs", "newton", "feedforward", "baumgarte", "settle"})
    all.push_back({method, "none", "none"});
  for (const int threads : {1, 2})
    for (const char* bath : {"rescaling", "langevin"})
      for (const char* barostat : {"none", "c-rescale", "monte-carlo"})
        all.push_back({"feedforward", bath, barostat, threads});
  all.push_back({"penalty", "langevin", "none"});
  return all;
}

class OfEach : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override { use_threads(GetParam().threads); }
  void TearDown() override { use_threads(1); }
};
INSTANTIATE_TEST_SUITE_P(Transaction, OfEach, testing::ValuesIn(cases()), [](const auto& about) {
  const Case& c = about.param;
  std::string name = c.method + "_" + c.bath + "_" + c.barostat + "_" + std::to_string(c.threads);
  std::ranges::replace(name, '-', '_');
  return name;
});

// Slower, and some atoms elsewhere.
void move_atoms(Simulation& simulation) {
  Vectors x = simulation.state().x, v = 0.5 * simulation.state().v;
  x.leftCols(3).array() += 0.01;
  x.col(5).array() += 0.002;
  simulation.set_out_anew(x, v);
}

TEST_P(OfEach, AtomsMovedInARunAreAsThoseMovedBetweenRuns) {
  Simulation watched(scene_of("water", GetParam().settings())),
      stopped(scene_of("water", GetParam().settings()));
  watched.run({}, [&](long step) {
    if (step != 20) return;
    const double before = watched.record().kinetic;
    move_atoms(watched);
    EXPECT_NEAR(watched.record().kinetic, 0.25 * before, 0.02 * before);
    EXPECT_LT(watched.record().bonds.max, GetParam().method == "penalty" ? 1e-2 : 1e-8);
  });
  stopped.run({}, [&](long step) {
    if (step == 20) stopped.stop();
  });
  move_atoms(stopped);
  stopped.run({});
  EXPECT_EQ(watched.step(), 60);
  EXPECT_TRUE(kept(watched) == kept(stopped));
}

// A weak field; throws when its turn comes.
class Interrupted : public OwnField {
 public:
  struct Interrupt {};

  std::string name() const override { return "interrupted"; }
  double add(const Vectors& x, Vectors& f) override {
    ++calls;
    if (calls == throws_at) throw Interrupt{};
    f.row(2).array() += 0.5;
    return -0.5 * x.row(2).sum();
  }

  long calls = 0, throws_at = -1;
};

struct Disturbed {
  explicit Disturbed(const Case& c) : scene(scene_of("water", c.settings())) {
    scene.terms.own.push_back(field);
    simulation.emplace(scene);
  }

  std::shared_ptr<Interrupted> field = std::make_shared<Interrupted>();
  Scene scene;
  std::optional<Simulation> simulation;
};

TEST_P(OfEach, AStepThatThrowsIsTakenBack) {
  Disturbed disturbed(GetParam()), other(GetParam());
  Simulation &simulation = *disturbed.simulation, &undisturbed = *other.simulation;
  for (const int steps : {21, 17}) {
    disturbed.field->throws_at = disturbed.field->calls + steps;
    EXPECT_THROW(simulation.run({}), Interrupted::Interrupt);
    EXPECT_EQ(disturbed.field->calls, disturbed.field->throws_at);
    undisturbed.run({}, [&](long step) {
      if (step == simulation.step()) undisturbed.stop();
    });
    EXPECT_GT(simulation.step(), 0);
    EXPECT_TRUE(simulation.energies() == undisturbed.energies());
    EXPECT_EQ(simulation.pressure_tensor(), undisturbed.pressure_tensor());
    EXPECT_EQ(simulation.bond_tensions(), undisturbed.bond_tensions());
    EXPECT_TRUE(kept(simulation) == kept(undisturbed)) << simulation.step();
  }
  for (Simulation* each : {&simulation, &undisturbed}) each->run({});
  EXPECT_EQ(simulation.step(), 60);
  EXPECT_TRUE(kept(simulation) == kept(undisturbed));
}

TEST_P(OfEach, AStartThatThrowsIsTakenBack) {
  Disturbed disturbed(GetParam());
  Simulation& simulation = *disturbed.simulation;
  simulation.run({}, [&](long step) {
    if (step != 20) return;
    const std::string before = kept(simulation);
    const auto energies = simulation.energies();
    for (const double minimise : {0.0, 10.0}) {
      disturbed.field->throws_at = disturbed.field->calls + (minimise > 0 ? 7 : 1);
      EXPECT_THROW(simulation.set_out_anew(simulation.state().x, simulation.state().v, {.force = minimise}),
                   Interrupted::Interrupt);
      EXPECT_EQ(disturbed.field->calls, disturbed.field->throws_at);
    }
    Vectors nowhere = simulation.state().x;
    nowhere.setZero();
    EXPECT_THROW(simulation.set_out_anew(nowhere, simulation.state().v), SimulationFailure);
    EXPECT_TRUE(simulation.energies() == energies);
    EXPECT_TRUE(kept(simulation) == before);
  });
  Disturbed undisturbed(GetParam());
  undisturbed.simulation->run({});
  EXPECT_TRUE(kept(simulation) == kept(*undisturbed.simulation));
}

TEST(Transaction, WhatFailsWithForeignCodeIsExplainedWithoutCallingItAgain) {
  Scene scene = scene_of("water", {"build.molecules=216", "run.dt_fs=6", "run.temperature_k=3000",
                                   "method.name=\"newton\"", "run.steps=1000"});
  Simulation plain(scene);
  const auto field = std::make_shared<Interrupted>();
  scene.terms.own.push_back(field);
  Simulation simulation(scene);
  EXPECT_THROW(simulation.run({}), SimulationFailure);
  const long calls = field->calls, taken = simulation.step();
  const auto diagnosis = simulation.diagnose();
  ASSERT_TRUE(diagnosis);
  EXPECT_EQ(field->calls, calls);
  EXPECT_EQ(diagnosis->step, taken + 1);
  EXPECT_EQ(simulation.step(), taken);
  EXPECT_GE(diagnosis->bond, 0);
  EXPECT_NEAR(diagnosis->length_before, diagnosis->held.length, 1e-6);
  EXPECT_LT(simulation.record().bonds.max, 1e-6);
  EXPECT_THROW(plain.run({}), SimulationFailure);
  EXPECT_EQ(plain.diagnose()->bond, diagnosis->bond);  // the field pulls all atoms alike, and weakly
}

// What is taken again, to see why, is what came after.
TEST(Transaction, WhatFailsAfterAtomsWereMovedIsFound) {
  Simulation simulation(
      scene_of("water", {"build.molecules=216", "method.name=\"newton\"", "run.steps=1000"}));
  double before = 0;
  const auto heat_up = [&](long step) {
    if (step != 20) return;
    before = simulation.record().kinetic;
    simulation.set_out_anew(simulation.state().x, 30 * simulation.state().v);
  };
  EXPECT_THROW(simulation.run({}, heat_up), SimulationFailure);
  const long failed = simulation.step();
  const auto diagnosis = simulation.diagnose();
  ASSERT_TRUE(diagnosis);
  EXPECT_EQ(diagnosis->step, failed);
  EXPECT_EQ(simulation.step(), failed - 1);
  EXPECT_GT(simulation.record().kinetic, 100 * before);
}

TEST(Transaction, ARunStoppedAtItsFirstRowTakesNoStep) {
  Simulation simulation(scene_of("pair"));
  simulation.run([&](const Record&) { simulation.stop(); });
  EXPECT_EQ(simulation.step(), 0);
}

TEST(Transaction, AtomsMovedAfterTheLastStepMakeNoSecondRow) {
  Simulation simulation(scene_of("pair", {"run.steps=20", "run.log_every=10"}));
  std::vector<long> rows;
  const Summary summary =
      simulation.run([&](const Record& r) { rows.push_back(r.step); },
                     [&](long step) {
                       if (step == 20)
                         simulation.set_out_anew(simulation.state().x, 0.5 * simulation.state().v);
                     });
  EXPECT_EQ(rows, (std::vector<long>{0, 10, 20}));
  EXPECT_TRUE(std::isfinite(summary.rms_rel_bond_error));
}

// Registers a method of the test's own, and returns its options.
template <class Method>
auto added(const char* name) {
  struct Options {
    std::vector<Option> describe() { return {}; }
  };
  const auto make = [](const System&, const std::any&, double) -> std::unique_ptr<ConstraintMethod> {
    return std::make_unique<Method>();
  };
  add_method({.name = name,
              .summary = "a test's",
              .defaults = Options{},
              .describe = [](std::any&) { return std::vector<Option>{}; },
              .make = make,
              .make_plain = make});
  return Options{};
}

// Takes 2³⁰ sweeps a step, or says so.
struct Busy : ConstraintMethod {
  SolveStats project_velocities(const System&, double, State&) override { return {.iterations = 1 << 30}; }
};

struct Countdown : ConstraintMethod {
  int n = 0;
  SolveStats add_forces(const System&, const Push& push, State&) override {
    return {.iterations = push.starts() ? 0 : ++n};
  }
};

// A row tells of the steps since the one before, the end's too.
TEST(Counters, BeginAgainAtEachRow) {
  Scene scene = scene_of("pendulum", {"run.steps=7", "run.log_every=3"});
  scene.method = added<Countdown>("countdown");
  Simulation simulation(scene);
  std::vector<long> steps;
  std::vector<double> iterations;
  simulation.run([&](const Record& r) { steps.push_back(r.step), iterations.push_back(r.iterations); });
  EXPECT_EQ(steps, (std::vector<long>{0, 3, 6, 7}));
  EXPECT_EQ(iterations, (std::vector<double>{0, (1 + 2 + 3) / 3., (4 + 5 + 6) / 3., 7}));
  scene.run.log_every = 0;
  EXPECT_THROW(Simulation(scene).run({}), InputError);
}

// However many there are between two rows of the log, what is kept in memory and in a checkpoint is sound.
TEST(Counters, GoOnAfterBillionsOfIterations) {
  Scene scene = scene_of("pendulum", {"run.steps=6", "run.log_every=6"});
  scene.method = added<Busy>("busy");
  Simulation first(scene), second(scene);
  std::string bytes;
  first.run({}, [&](long step) {
    if (step == 5) bytes = kept(first);
  });
  second.restore(bytes);
  EXPECT_EQ(second.step(), 5);
  Record last;
  second.run([&](const Record& r) { last = r; });
  EXPECT_EQ(last.iterations, 1 << 30);
}

}  // namespace
}  // namespace taut::transaction_tests
