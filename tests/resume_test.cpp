// A run that stops at a checkpoint and goes on is, to the last bit, the run that never stopped.

#include <gtest/gtest.h>
#include <malloc.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "base/errors.hpp"
#include "kept_state.hpp"
#include "named_scene.hpp"
#include "simulation/checkpoint.hpp"
#include "simulation/simulation.hpp"

namespace taut::resume_tests {
namespace {

using Overrides = std::vector<std::string>;

struct Course {
  std::vector<Record> rows;
  std::vector<Eigen::VectorXd> tensions;  // at each row
  State end;
  std::string kept_at_end;
  Summary summary;

  auto watching(const Simulation& simulation) {
    return [&](const Record& r) {
      rows.push_back(r);
      tensions.push_back(simulation.bond_tensions());
    };
  }

  void finish(Simulation& simulation) {
    summary = simulation.run(watching(simulation));
    end = simulation.state();
    kept_at_end = kept(simulation);
  }
};

Course in_one_go(const std::string& scene, const Overrides& overrides) {
  Course course;
  Simulation simulation(scene_of(scene, overrides));
  course.finish(simulation);
  return course;
}

std::string checkpoint_of(Simulation& simulation, const Overrides& overrides) {
  return to_bytes({source_of(simulation.scene(), overrides),
                   simulation.step(),
                   simulation.state().t,
                   1,
                   kept(simulation),
                   {}});
}

// Its checkpoint after some step.
std::string stopped_at(long stop, Simulation& simulation, const Overrides& overrides, Course& course) {
  std::string bytes;
  simulation.run(course.watching(simulation), [&](long step) {
    if (step != stop) return;
    bytes = checkpoint_of(simulation, overrides);
    simulation.stop();
  });
  return bytes;
}

std::unique_ptr<Simulation> made_from(const std::string& bytes) {
  const Checkpoint checkpoint = read_checkpoint(bytes);
  auto simulation = std::make_unique<Simulation>(checkpoint.source.read());
  simulation->restore(checkpoint.memory);
  EXPECT_EQ(simulation->step(), checkpoint.step);
  return simulation;
}

// Through a checkpoint's bytes, into a simulation made of nothing else.
Course with_a_stop(const std::string& name, const Overrides& overrides, long stop) {
  Course course;
  Simulation simulation(scene_of(name, overrides));
  const std::string bytes = stopped_at(stop, simulation, overrides, course);
  course.finish(*made_from(bytes));
  return course;
}

// Positions, velocities, and all that figures are made of are among what is kept.
void expect_same(const Course& a, const Course& b) {
  EXPECT_TRUE(a.kept_at_end == b.kept_at_end);
  EXPECT_EQ(a.end.t, b.end.t);
  ASSERT_EQ(a.rows.size(), b.rows.size());
  for (std::size_t n = 0; n < a.rows.size(); ++n) {
    const Record &r = a.rows[n], &s = b.rows[n];
    const auto figures = [](const Record& of) {
      return std::tie(of.step, of.t, of.potential, of.kinetic, of.temperature, of.bonds.max, of.bonds.rms,
                      of.volume, of.constraint_work, of.heat, of.iterations, of.pressure);
    };
    EXPECT_TRUE(figures(r) == figures(s)) << r.step;
    EXPECT_TRUE(r.drift == s.drift || (std::isnan(r.drift) && std::isnan(s.drift))) << r.step;
    EXPECT_TRUE(a.tensions[n] == b.tensions[n]) << r.step;
  }
  EXPECT_EQ(a.summary.max_rel_bond_error, b.summary.max_rel_bond_error);
  EXPECT_EQ(a.summary.temperature, b.summary.temperature);
  EXPECT_EQ(a.summary.constraint_drift.error, b.summary.constraint_drift.error);
}

struct Case {
  std::string scene, method;
  Overrides overrides;
  long stop, steps;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.method << " on " << c.scene;
  for (const auto& o : c.overrides) *out << " " << o;
}

// Every method: in lanes, on waters with lists of pairs; by itself, where an anchor ties the bonds; on a
// chain long enough to be cut.
std::vector<Case> cases() {
  std::vector<Case> all;
  for (const std::string_view name : method_names()) {
    const std::string method(name);
    all.push_back({"water", method, {"run.dt_fs=0.5"}, 50, 120});
    if (method == "settle") continue;
    all.push_back({"double_pendulum", method, {"run.dt_fs=0.2"}, 400, 1000});
    all.push_back({"freely_jointed", method, {"build.chains=5"}, 400, 1000});
    all.push_back(
        {"freely_jointed", method, {"build.chains=1", "build.beads=1500"}, 20, 50});  // cut in pieces
  }
  for (const char* thermostat : {"run.thermostat=\"langevin\"", "run.thermostat_ps=0.05"})
    for (const std::string_view name : method_names()) {
      const std::string method(name);
      all.push_back({"water", method, {"run.dt_fs=0.5", "run.log_every=3", thermostat}, 50, 120});
      if (method == "settle") continue;
      all.push_back({"freely_jointed",
                     method,
                     {"build.chains=5", "run.dt_fs=1", "run.temperature_k=120", thermostat},
                     400,
                     1000});
    }
  for (const char* precision : {"double", "mixed"})
    for (const char* scene : {"water", "melt", "water_cluster"})
      all.push_back({scene, "newton", {std::string("forcefield.precision=\"") + precision + "\""}, 130, 300});
  for (const char* precision : {"double", "mixed"})
    for (const char* method : {"newton", "feedforward"})
      all.push_back(
          {"water",
           method,
           {"forcefield.coulomb=\"pme\"", std::string("forcefield.precision=\"") + precision + "\""},
           130,
           300});
  const Overrides skewed = {"build.box=\"octahedron\"", "build.molecules=300", "run.dt_fs=0.5",
                            "forcefield.coulomb=\"pme\""};
  all.push_back({"water", "newton", skewed, 130, 300});
  Overrides pressed = skewed;
  pressed.insert(pressed.end(), {"run.thermostat=\"langevin\"", "run.barostat=\"c-rescale\""});
  all.push_back({"water", "feedforward", pressed, 130, 300});
  all.push_back({"water", "rattle", {"run.remove_momentum_every=7"}, 50, 120});
  for (const char* barostat : {"run.barostat=\"c-rescale\"", "run.barostat=\"monte-carlo\""})
    for (const char* method : {"feedforward", "baumgarte"})
      for (const char* stop_at : {"run.barostat_every=7", "run.barostat_every=10"})  // 10: a move to come
        all.push_back({"water",
                       method,
                       {"run.dt_fs=1", "run.log_every=3", "run.thermostat=\"langevin\"", barostat, stop_at,
                        "forcefield.coulomb=\"pme\""},
                       50,
                       120});
  return all;
}

class Resumed : public ::testing::TestWithParam<Case> {};

TEST_P(Resumed, IsTheRunThatNeverStopped) {
  auto [scene, method, overrides, stop, steps] = GetParam();
  overrides.push_back("method.name=\"" + method + "\"");
  overrides.push_back("run.steps=" + std::to_string(steps));
  if (std::ranges::find(overrides, "run.log_every=3") == overrides.end())
    overrides.push_back("run.log_every=30");
  expect_same(in_one_go(scene, overrides), with_a_stop(scene, overrides, stop));
}
INSTANTIATE_TEST_SUITE_P(All, Resumed, ::testing::ValuesIn(cases()),
                         [](const auto& test) { return "case" + std::to_string(test.index); });

struct Change {
  Overrides before, after;
};
class ChangedThermostat : public ::testing::TestWithParam<Change> {};

// What a checkpoint after the change makes is what goes on without it, though the scene's start, with its
// momentum and its counts, was another thermostat's.
TEST_P(ChangedThermostat, GoesOnFromACheckpointAsWithoutOne) {
  Overrides keys = {"method.name=\"feedforward\"", "run.log_every=5", "run.steps=150"};
  Overrides before = keys, after = keys;
  before.insert(before.end(), GetParam().before.begin(), GetParam().before.end());
  after.insert(after.end(), GetParam().after.begin(), GetParam().after.end());
  const RunSettings settings = scene_of("water", after).run;
  Course whole, parts;
  Simulation one(scene_of("water", before)), other(scene_of("water", before));
  for (const auto& [simulation, course] : {std::pair(&one, &whole), std::pair(&other, &parts)}) {
    stopped_at(50, *simulation, before, *course);
    simulation->change(settings);
  }
  whole.finish(one);
  const auto again = made_from(stopped_at(98, other, after, parts));
  EXPECT_EQ(again->dof().total(), one.dof().total());
  parts.finish(*again);
  expect_same(whole, parts);
  EXPECT_EQ(whole.rows[10].step, 50);
  EXPECT_EQ(whole.rows[11].step, 55);  // no row twice
}
INSTANTIATE_TEST_SUITE_P(
    All, ChangedThermostat,
    ::testing::Values(
        Change{{}, {"run.thermostat=\"langevin\""}},
        Change{{"run.thermostat=\"langevin\""},
               {"run.thermostat=\"langevin\"", "run.barostat=\"c-rescale\""}},
        Change{{}, {"run.thermostat=\"rescaling\"", "run.thermostat_ps=0.02"}},
        Change{{"run.thermostat=\"langevin\""}, {}},
        Change{{"run.thermostat=\"langevin\""}, {"run.thermostat=\"langevin\"", "run.temperature_k=400"}},
        Change{{"run.thermostat=\"langevin\""}, {"run.thermostat=\"rescaling\"", "run.thermostat_ps=0.02"}},
        Change{{"run.thermostat=\"rescaling\"", "run.thermostat_ps=0.02"},
               {"run.thermostat=\"rescaling\"", "run.thermostat_ps=0.02", "run.temperature_k=400"}}),
    [](const auto& test) { return "case" + std::to_string(test.index); });

// A thermostat takes its temperature from the change on; one that is as it was, is left as it was.
TEST(Changing, IsOfTheStepsToCome) {
  const auto ended_at = [](const char* temperature) {
    Simulation simulation(
        scene_of("water", {"run.thermostat_ps=0.005", "run.steps=200", "run.log_every=10"}));
    Course course;
    stopped_at(100, simulation, {}, course);
    RunSettings settings = simulation.scene().run;
    settings.steps = 300;
    settings.temperature_k = std::stod(temperature);
    simulation.change(settings);
    course.finish(simulation);
    EXPECT_NEAR(course.end.t, 300 * settings.h(), 1e-12);
    return course.summary.temperature;
  };
  EXPECT_NEAR(ended_at("298.15"), 298, 25);
  EXPECT_NEAR(ended_at("450"), 440, 30);

  Simulation simulation(scene_of("water", {"run.steps=60"}));
  Course whole = in_one_go("water", {"run.steps=60", "run.log_every=10"}), course;
  stopped_at(30, simulation, {}, course);
  RunSettings settings = simulation.scene().run;
  settings.log_every = 10;
  simulation.change(settings);
  course.finish(simulation);
  EXPECT_TRUE(course.end.x == whole.end.x);
}

TEST(Resuming, RefusesTheMemoryOfAnother) {
  Simulation waters(scene_of("water")), chains(scene_of("freely_jointed"));
  EXPECT_THROW(waters.restore(kept(chains)), InputError);
  std::string longer = kept(waters) + "x";
  EXPECT_THROW(waters.restore(longer), InputError);
  EXPECT_THROW(waters.restore(std::string_view(longer).substr(0, longer.size() / 2)), InputError);
}

TEST(Recalling, RefusesAStepThatIsNone) {
  Simulation simulation(scene_of("pair"));
  const State& s = simulation.state();
  std::string bytes = kept(simulation);
  const auto matrix = [](const Vectors& x) { return 8 + static_cast<std::size_t>(x.size()) * 8; };
  const std::size_t step = matrix(s.x) + matrix(s.v) + matrix(s.f) + 8;
  for (const long value : {-1L, std::numeric_limits<long>::min()}) {
    std::memcpy(&bytes[step], &value, sizeof value);
    EXPECT_THROW(simulation.restore(bytes), InputError) << value;
  }
}

// The state after diagnose() is that of a run one step shorter; the failing step is found, not the row after.
TEST(Diagnosed, LastGoodStateIsTheOneBefore) {
  const Overrides hot = {"run.dt_fs=6", "run.temperature_k=3000", "method.name=\"newton\"",
                         "run.log_every=1000", "run.steps=1000"};
  Simulation failing(scene_of("water", hot));
  EXPECT_THROW(failing.run({}), SimulationFailure);
  const long failed = failing.step();
  ASSERT_LT(failed, 1000);
  const auto diagnosis = failing.diagnose();
  ASSERT_TRUE(diagnosis);
  EXPECT_EQ(diagnosis->step, failed);
  EXPECT_EQ(failing.step(), failed - 1);

  Overrides shorter = hot;
  shorter.push_back("run.steps=" + std::to_string(failed - 1));
  Simulation good(scene_of("water", shorter));
  good.run({});
  EXPECT_TRUE(good.state().x == failing.state().x);
  EXPECT_TRUE(good.state().v == failing.state().v);
  ASSERT_GE(diagnosis->bond, 0);
  const auto [i, j, length] = good.scene().system.bonds[diagnosis->bond];
  EXPECT_EQ(diagnosis->length_before, (good.state().x.col(j) - good.state().x.col(i)).norm());
  EXPECT_NEAR(diagnosis->length_before, length, 1e-9);
  EXPECT_GT(std::abs(diagnosis->length - length), 0.01 * length);
}

// Steps 455 and 102: in half the step's length about twice the time, and the message says so.
TEST(Diagnosed, NoneFailsByItsNature) {
  std::vector<double> lasted;  // [ps]
  for (const char* step : {"run.dt_fs=1", "run.dt_fs=2"}) {
    Simulation failing(scene_of("water", {step, "method.name=\"none\"", "run.steps=1000"}));
    EXPECT_THROW(failing.run({}), SimulationFailure);
    const auto diagnosis = failing.diagnose();
    ASSERT_TRUE(diagnosis);
    EXPECT_EQ(diagnosis->cause,
              "a bond ran off: with none nothing brings an error back, it grows as (time × step)²");
    EXPECT_NE(diagnosis->advice.find("baumgarte"), std::string::npos);
    EXPECT_LT(diagnosis->largest_force, 1e4);  // no atoms on each other
    lasted.push_back(diagnosis->t);
  }
  EXPECT_NEAR(lasted[0] / lasted[1], 2, 0.5);
}

TEST(Diagnosed, NothingWhereAnObserverThrew) {
  Simulation simulation(scene_of("pendulum"));
  EXPECT_THROW(simulation.run([](const Record&) { throw SimulationFailure("enough"); }), SimulationFailure);
  EXPECT_FALSE(simulation.diagnose());
}

TEST(MemoryInUse, DoesNotGrowWithSteps) {
  Simulation simulation(scene_of("melt", {"run.steps=4000", "run.log_every=50", "run.thermostat_ps=0.1"}));
  std::size_t early = 0, late = 0;
  simulation.run([](const Record&) {},
                 [&](long step) {
                   if (step == 2000) early = mallinfo2().uordblks;
                   if (step == 4000) late = mallinfo2().uordblks;
                 });
  EXPECT_LT(late, early + 100000);  // lists swing
}

}  // namespace
}  // namespace taut::resume_tests
