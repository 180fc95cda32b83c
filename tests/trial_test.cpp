// Runs of a setting, as charts and other studies try them.

#include "studies/trial.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "error_message.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut::trial_tests {
namespace {

// Without gains an error grows as the square of the time.
TEST(Trial, SaysThatAnErrorIsNotAtRest) {
  const Scene scene = read_scene(find_scene("freely_jointed"), {"build.chains=5", "run.dt_fs=2"});
  const TrialPlan plan{.start = 50, .steps = 400, .rows = 100};
  const Trial none = try_setting(scene, setting_of("none"), plan),
              newton = try_setting(scene, setting_of("newton"), plan);
  EXPECT_GT(none.later_over_earlier, 2);
  EXPECT_FALSE(none.at_rest());
  EXPECT_GT(none.error_slope.value, 5 * none.error_slope.error);
  EXPECT_TRUE(newton.at_rest()) << newton.later_over_earlier << " ± " << newton.error_slope.error;
}

TEST(Trial, TakesAMethodWithItsSettings) {
  const Setting one = setting_of("rattle:sweeps=4,warm_start=false");
  EXPECT_THAT(one.overrides,
              testing::ElementsAre("method.name=rattle", "method.sweeps=4", "method.warm_start=false"));
  EXPECT_EQ(settings_of("rattle:sweeps=4", 0.002, false).size(), 1u);
  EXPECT_GT(settings_of("rattle", 0.002, false).size(), 5u);
  EXPECT_THAT(error_message([] { method_in_word("rattle:sweps=4"); }),
              testing::AllOf(testing::StartsWith("rattle:sweps=4: "), testing::HasSubstr("\"sweeps\"")));
  EXPECT_THAT(error_message([] { method_in_word("rattle:4"); }),
              testing::HasSubstr("rattle:4: \"4\" is no setting"));
  EXPECT_THAT(error_message([] { method_in_word("ratle:sweeps=4"); }), testing::HasSubstr("\"rattle\""));
}

// A drift is uncertain by what the run itself says, and by nothing of the study's own.
TEST(Trial, HasTheRunsOwnErrorOfTheDrift) {
  const Scene scene = read_scene(find_scene("freely_jointed"), {"build.chains=5"});
  const Setting newton = setting_of("newton");
  Scene same = scene;
  apply_overrides(same, {"method.name=newton", "run.steps=400", "run.log_every=10"});
  const Estimate drift = Simulation(same).run({}).drift;
  const Trial trial = try_setting(scene, newton, {.steps = 400, .rows = 40});
  ASSERT_GT(drift.error, 0);
  EXPECT_EQ(trial.drift, drift.value);
  EXPECT_EQ(trial.drift_error, drift.error);
  EXPECT_EQ(trial.constraint_drift.value, Simulation(same).run({}).constraint_drift.value);
  EXPECT_NEAR(trial.drift_high() - trial.drift_low(), 2 * 1.96 * drift.error, 1e-12 * drift.error);
  const Trial of_few_rows = try_setting(scene, newton, {.steps = 400, .rows = 10});
  EXPECT_EQ(of_few_rows.drift_low(), of_few_rows.drift);
}

}  // namespace
}  // namespace taut::trial_tests
