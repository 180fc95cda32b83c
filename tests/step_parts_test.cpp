// Where the time of a run goes: parts that do not overlap and add up to the whole.
#include "md/step_parts.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <map>

#include "base/threads.hpp"
#include "kept_state.hpp"
#include "named_scene.hpp"
#include "simulation/simulation.hpp"

namespace taut::step_parts_tests {
namespace {

using enum StepPart;

void spin(double seconds) {
  const auto start = std::chrono::steady_clock::now();
  while (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < seconds) continue;
}

std::map<StepPart, PartTime> times_of(const PartMeter& meter) {
  std::map<StepPart, PartTime> times;
  for (const PartTime& time : meter.times()) times[time.part] = time;
  return times;
}

TEST(PartMeter, CountsATimeOnceInTheInnermostPart) {
  const PartMeter meter(1, PartMeter::Parts::kAll);
  spin(0.002);
  in_part(kPrune, [] {
    spin(0.01);
    in_part(kPairSearch, [] { spin(0.03); });
    in_part(kPairSearch, [] { spin(0.01); });
  });
  const double before = meter.seconds();
  auto times = times_of(meter);
  const double after = meter.seconds();
  EXPECT_EQ(times[kPrune].calls, 1);
  EXPECT_EQ(times[kPairSearch].calls, 2);
  EXPECT_GE(times[kPrune].seconds, 0.0099);
  EXPECT_GE(times[kPairSearch].seconds, 0.0399);
  EXPECT_EQ(times.size(), 3u) << "a part that was not called is not there";
  double sum = 0;
  for (const auto& [part, time] : times) sum += time.seconds;
  EXPECT_GE(sum, 0.98 * before);
  EXPECT_LE(sum, 1.02 * after);
}

TEST(PartMeter, BarostatAndLogKeepWhatTheyAskFor) {
  const PartMeter meter(1, PartMeter::Parts::kAll);
  in_part(kBarostat, [] { in_part(kPairs, [] { spin(0.005); }); });
  in_part(kPairs, [] { spin(0.001); });
  auto times = times_of(meter);
  EXPECT_EQ(times[kPairs].calls, 1);
  EXPECT_GE(times[kBarostat].seconds, 0.0049);
}

TEST(PartMeter, MeasuresTheBondsAloneWhereThatIsAsked) {
  const PartMeter meter(1, PartMeter::Parts::kBonds);
  in_part(kPairs, [] { in_part(kBonds, [] { spin(0.002); }); });
  EXPECT_GE(meter.seconds_of(kBonds), 0.0019);
  EXPECT_EQ(meter.seconds_of(kPairs), 0);
  EXPECT_TRUE(meter.times().empty());
}

TEST(PartMeter, SaysHowLongThreadsWait) {
  const PartMeter meter(4, PartMeter::Parts::kAll);
  in_part(kMeshSpread, [] { in_parallel(4, [](int t) { spin(t == 0 ? 0.004 : 0.001); }); });
  in_part(kBonds, [] { spin(0.002); });  // by one of four
  auto times = times_of(meter);
  const PartTime bonds = times[kBonds], spread = times[kMeshSpread];
  EXPECT_NEAR(bonds.waiting / bonds.seconds, 3, 0.01);
  EXPECT_GT(spread.waiting, 0);
  EXPECT_LE(spread.waiting, 1.01 * (4 * spread.seconds - 0.007)) << "7 ms of the four threads' time are work";
}

// What a region does on the thread that starts it belongs to the region's part.
TEST(PartMeter, RegionsBelongToThePartThatStartsThem) {
  const PartMeter meter(2, PartMeter::Parts::kAll);
  in_part(kPairs, [] { in_parallel(2, [](int) { in_part(kBonded, [] { spin(0.001); }); }); });
  auto times = times_of(meter);
  EXPECT_FALSE(times.contains(kBonded));
  in_part(kBonded, [] {});
  EXPECT_TRUE(times_of(meter).contains(kBonded)) << "the meter goes on after the region";
}

TEST(PartMeter, AnInnerOneTakesOverAndGivesBack) {
  const PartMeter outer(1, PartMeter::Parts::kAll);
  {
    const PartMeter inner(1, PartMeter::Parts::kAll);
    in_part(kPairs, [] {});
    EXPECT_TRUE(times_of(inner).contains(kPairs));
  }
  EXPECT_FALSE(times_of(outer).contains(kPairs));
  in_part(kPairs, [] {});
  EXPECT_TRUE(times_of(outer).contains(kPairs));
}

Timings timings_of(const std::string& scene, const std::vector<std::string>& overrides, int threads = 1,
                   std::string* bits = nullptr, bool asked = true) {
  Simulation simulation(scene_of(scene, overrides), threads);
  if (asked) simulation.measure_parts();
  const Summary summary = simulation.run({});
  EXPECT_GT(summary.constraint_us_per_step, 0);
  if (bits) *bits = kept(simulation);
  return summary.timings;
}

TEST(Timings, PartsAddUpToTheRunAndNoneIsThereThatTheSceneHasNot) {
  for (const int threads : {1, 2}) {
    const auto start = std::chrono::steady_clock::now();
    const Timings t = timings_of("water", {"run.steps=10", "forcefield.coulomb=pme"}, threads);
    const double around = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    double sum = 0;
    std::map<StepPart, long> calls;
    for (const PartTime& part : t.parts) sum += part.seconds, calls[part.part] = part.calls;
    EXPECT_DOUBLE_EQ(sum, t.seconds());
    EXPECT_LE(sum, 1.02 * around) << "no time counts twice";
    EXPECT_EQ(t.steps, 10);
    for (const StepPart part : {kPairs, kMeshSpread, kMeshSolve, kMeshGather, kExclusions})
      EXPECT_EQ(calls[part], 10) << name_of(part);
    EXPECT_EQ(calls[kBonds], 30);
    for (const StepPart part : {kBonded, kFields, kSites, kThermostat, kBarostat})
      EXPECT_FALSE(calls.contains(part)) << name_of(part);
    for (const PartTime& part : t.parts) EXPECT_GE(part.waiting, 0) << name_of(part.part);
  }
}

TEST(Timings, HaveWhatTheSceneAsksFor) {
  const Timings t =
      timings_of("decane", {"run.steps=20", "run.thermostat=langevin", "run.friction_per_ps=1",
                            "run.barostat=monte-carlo", "run.barostat_every=10", "run.pressure_bar=1"});
  std::map<StepPart, long> calls;
  for (const PartTime& part : t.parts) calls[part.part] = part.calls;
  EXPECT_EQ(calls[kBonded], 20) << "trials belong to the barostat";
  EXPECT_EQ(calls[kBarostat], 1);
  EXPECT_EQ(calls[kThermostat], 20);
}

TEST(Timings, ChangeNoBits) {
  std::string measured, unmeasured;
  const std::vector<std::string> small = {"run.steps=20"};
  EXPECT_FALSE(timings_of("water", small, 1, &measured).parts.empty());
  EXPECT_TRUE(timings_of("water", small, 1, &unmeasured, false).parts.empty());
  EXPECT_EQ(measured, unmeasured);
}

}  // namespace
}  // namespace taut::step_parts_tests
