// A run that stops at a checkpoint and goes on is, to the last bit, the run that never stopped.

#include <gtest/gtest.h>
#include <malloc.h>

#include <nlohmann/json.hpp>

#include "md/errors.hpp"
#include "systems/checkpoint.hpp"
#include "systems/scene_file.hpp"
#include "systems/simulation.hpp"

namespace taut {
namespace {

using Overrides = std::vector<std::string>;

Scene read(const std::string& name, const Overrides& overrides) {
  return read_scene(find_scene(name), overrides);
}

std::string kept(Simulation& simulation) {
  std::string bytes;
  Memory memory = Memory::keep_in(bytes);
  simulation.remember(memory);
  return bytes;
}

struct Course {
  std::vector<Record> rows;
  State end;
};

Course in_one_go(const std::string& scene, const Overrides& overrides) {
  Course course;
  Simulation simulation(read(scene, overrides));
  simulation.run([&](const Record& r) { course.rows.push_back(r); });
  course.end = simulation.state();
  return course;
}

// Through a checkpoint's bytes, into a simulation made of nothing else.
Course with_a_stop(const std::string& name, const Overrides& overrides, long stop) {
  Course course;
  const auto on_record = [&](const Record& r) { course.rows.push_back(r); };
  std::string bytes;
  {
    Simulation simulation(read(name, overrides));
    simulation.run(on_record, [&](long step) {
      if (step != stop) return;
      bytes = to_bytes({source_of(simulation.scene(), false, overrides),
                        step,
                        simulation.state().t,
                        1,
                        kept(simulation),
                        {}});
      simulation.stop();
    });
  }
  const Checkpoint checkpoint = read_checkpoint(bytes);
  EXPECT_EQ(checkpoint.step, stop);
  Simulation simulation(checkpoint.source.read());
  simulation.recall(checkpoint.memory);
  simulation.run(on_record);
  course.end = simulation.state();
  return course;
}

void expect_same(const Course& a, const Course& b) {
  EXPECT_TRUE(a.end.x == b.end.x);
  EXPECT_TRUE(a.end.v == b.end.v);
  EXPECT_TRUE(a.end.f == b.end.f);
  EXPECT_EQ(a.end.t, b.end.t);
  ASSERT_EQ(a.rows.size(), b.rows.size());
  for (std::size_t n = 0; n < a.rows.size(); ++n) {
    const Record &r = a.rows[n], &s = b.rows[n];
    EXPECT_EQ(r.step, s.step);
    EXPECT_EQ(r.t, s.t) << r.step;
    EXPECT_EQ(r.potential, s.potential) << r.step;
    EXPECT_EQ(r.kinetic, s.kinetic) << r.step;
    EXPECT_EQ(r.temperature, s.temperature) << r.step;
    EXPECT_EQ(r.bonds.max, s.bonds.max) << r.step;
    EXPECT_EQ(r.bonds.rms, s.bonds.rms) << r.step;
    EXPECT_EQ(r.drift, s.drift) << r.step;
    EXPECT_EQ(r.iterations, s.iterations) << r.step;
  }
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
    for (const char* method : {"rattle", "newton", "baumgarte", "feedforward"}) {
      all.push_back(
          {"freely_jointed", method, {"build.chains=5", "run.temperature_k=120", thermostat}, 400, 1000});
      all.push_back({"water", method, {thermostat}, 50, 120});
    }
  for (const char* precision : {"double", "mixed"})
    for (const char* scene : {"water", "melt", "water_cluster"})
      all.push_back({scene, "newton", {std::string("forcefield.precision=\"") + precision + "\""}, 130, 300});
  all.push_back({"water", "rattle", {"run.remove_momentum_every=7"}, 50, 120});
  return all;
}

class Resumed : public ::testing::TestWithParam<Case> {};

TEST_P(Resumed, IsTheRunThatNeverStopped) {
  auto [scene, method, overrides, stop, steps] = GetParam();
  overrides.push_back("method.name=\"" + method + "\"");
  overrides.push_back("run.steps=" + std::to_string(steps));
  overrides.push_back("run.log_every=30");
  expect_same(in_one_go(scene, overrides), with_a_stop(scene, overrides, stop));
}
INSTANTIATE_TEST_SUITE_P(All, Resumed, ::testing::ValuesIn(cases()),
                         [](const auto& test) { return "case" + std::to_string(test.index); });

// What this file would not see if nothing depended on it.
TEST(Resuming, DependsOnMoreThanTheState) {
  const Overrides overrides = {"run.steps=60", "method.name=\"rattle\""};
  Simulation whole(read("water", overrides));
  State middle;
  whole.run({}, [&](long step) {
    if (step == 30) middle = whole.state();
  });
  Scene scene = read("water", {"run.steps=30", "method.name=\"rattle\""});
  scene.start = middle;
  Simulation again(std::move(scene));
  again.run({});
  EXPECT_FALSE(again.state().x == whole.state().x);
  EXPECT_LT((again.state().x - whole.state().x).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Resuming, RefusesTheMemoryOfAnother) {
  Simulation waters(read("water", {})), chains(read("freely_jointed", {}));
  EXPECT_THROW(waters.recall(kept(chains)), InputError);
  std::string longer = kept(waters) + "x";
  EXPECT_THROW(waters.recall(longer), InputError);
  EXPECT_THROW(waters.recall(std::string_view(longer).substr(0, longer.size() / 2)), InputError);
}

Checkpoint some_checkpoint() {
  return {{true, {{"a.xml", "<a>\xff\n"}, {"b.xml", ""}}, {"run.seed=3"}},
          41,
          0.1,
          2,
          std::string("\0\1\2", 3),
          {{"log.csv", 123456}}};
}

TEST(CheckpointFormat, SaysBackWhatItWasTold) {
  const Checkpoint c = some_checkpoint(), back = read_checkpoint(to_bytes(c));
  EXPECT_EQ(back.source.openmm, true);
  ASSERT_EQ(back.source.files.size(), 2u);
  EXPECT_EQ(back.source.files[0].name, "a.xml");
  EXPECT_EQ(back.source.files[0].text, c.source.files[0].text);
  EXPECT_EQ(back.source.overrides, c.source.overrides);
  EXPECT_EQ(back.step, 41);
  EXPECT_EQ(back.t, 0.1);
  EXPECT_EQ(back.threads, 2);
  EXPECT_EQ(back.memory, c.memory);
  EXPECT_EQ(back.marks, c.marks);
}

TEST(CheckpointFormat, NoDamageGoesUnseen) {
  const std::string whole = to_bytes(some_checkpoint());
  for (std::size_t n = 0; n < whole.size(); ++n) {
    EXPECT_THROW(read_checkpoint(whole.substr(0, n)), InputError) << n;
    std::string damaged = whole;
    damaged[n] = static_cast<char>(damaged[n] ^ 0x10);
    EXPECT_THROW(read_checkpoint(damaged), InputError) << n;
  }
  EXPECT_THROW(read_checkpoint(whole + "x"), InputError);
}

std::string refusal(std::string_view bytes) {
  try {
    read_checkpoint(bytes);
  } catch (const InputError& e) {
    return e.what();
  }
  return "none";
}

TEST(CheckpointFormat, SaysWhatIsWrong) {
  using nlohmann::json;
  json envelope = json::from_cbor(to_bytes(some_checkpoint()));
  envelope["version"] = 7;
  const auto later = json::to_cbor(envelope);
  EXPECT_EQ(refusal({reinterpret_cast<const char*>(later.data()), later.size()}),
            "a checkpoint of version 7, this taut reads version 1");
  EXPECT_EQ(refusal("[run]\nsteps = 3\n"), "not a checkpoint, or not all of it");
  EXPECT_EQ(refusal(""), "not a checkpoint, or not all of it");
}

// Sizes are taken on trust by nobody: neither the stack nor the heap follows them.
TEST(CheckpointFormat, LiesAboutSizesAndDepthAreRefused) {
  EXPECT_THROW(read_checkpoint(std::string(1000000, '\x81')), InputError);  // an array in an array in ...
  EXPECT_THROW(read_checkpoint(std::string("\x5b\x00\x00\x10\x00\x00\x00\x00\x00", 9)),
               InputError);  // 2⁴⁴ bytes
  EXPECT_THROW(read_checkpoint(std::string("\x9b\x00\x00\x10\x00\x00\x00\x00\x00", 9)),
               InputError);  // 2⁴⁴ things
  EXPECT_THROW(read_checkpoint_body(std::string("\xbf\x64step\xfb\x7f\xf0\0\0\0\0\0\0\xff", 16)), InputError);
}

// The state after diagnose() is that of a run one step shorter; the failing step is found, not the row after.
TEST(Diagnosed, LastGoodStateIsTheOneBefore) {
  const Overrides hot = {"run.dt_fs=6", "run.temperature_k=3000", "method.name=\"newton\"",
                         "run.log_every=1000", "run.steps=1000"};
  Simulation failing(read("water", hot));
  EXPECT_THROW(failing.run({}), SimulationFailure);
  const long failed = failing.step();
  ASSERT_LT(failed, 1000);
  const auto diagnosis = failing.diagnose();
  ASSERT_TRUE(diagnosis);
  EXPECT_EQ(diagnosis->step, failed);
  EXPECT_EQ(failing.step(), failed - 1);

  Overrides shorter = hot;
  shorter.push_back("run.steps=" + std::to_string(failed - 1));
  Simulation good(read("water", shorter));
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
    Simulation failing(read("water", {step, "method.name=\"none\"", "run.steps=1000"}));
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
  Simulation simulation(read("pendulum", {}));
  EXPECT_THROW(simulation.run([](const Record&) { throw SimulationFailure("enough"); }), SimulationFailure);
  EXPECT_FALSE(simulation.diagnose());
}

TEST(MemoryInUse, DoesNotGrowWithSteps) {
  Simulation simulation(read("melt", {"run.steps=4000", "run.log_every=50", "run.thermostat_ps=0.1"}));
  std::size_t early = 0, late = 0;
  simulation.run([](const Record&) {},
                 [&](long step) {
                   if (step == 2000) early = mallinfo2().uordblks;
                   if (step == 4000) late = mallinfo2().uordblks;
                 });
  EXPECT_LT(late, early + 100000);  // lists swing
}

}  // namespace
}  // namespace taut
