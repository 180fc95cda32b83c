// The curves of `taut chart` and `taut stability` move as theory says, read from the CSV they are drawn from.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "base/errors.hpp"
#include "error_message.hpp"
#include "measures/csv.hpp"
#include "scene_text.hpp"
#include "simulation/simulation.hpp"
#include "studies/chart_study.hpp"
#include "studies/chart_verdict.hpp"
#include "studies/stability_study.hpp"
#include "studies/trial.hpp"
#include "systems/scene/scene_file.hpp"
#include "temporary_folder.hpp"

namespace taut::study_tests {
namespace {

// Rows by column name, as text.
class Table {
 public:
  explicit Table(const std::string& csv) : rows_(csv_rows(csv)) {}

  std::string text(const std::string& column,
                   const std::vector<std::pair<std::string, std::string>>& where) const {
    for (const auto& row : rows_) {
      bool fits = true;
      for (const auto& [key, value] : where) fits &= row[at(key)] == value;
      if (fits) return row[at(column)];
    }
    ADD_FAILURE() << "no row for " << column << " with " << where.back().second;
    return "";
  }
  double number(const std::string& column,
                const std::vector<std::pair<std::string, std::string>>& where) const {
    const std::string cell = text(column, where);
    return cell.empty() ? std::nan("") : std::stod(cell);
  }

 private:
  std::size_t at(const std::string& column) const {
    return static_cast<std::size_t>(std::ranges::find(rows_[0], column) - rows_[0].begin());
  }

  std::vector<std::vector<std::string>> rows_;
};

void run(const std::vector<Job>& jobs, Ledger& ledger) {
  for (const Job& job : jobs) ledger.once(job.name, job.make);
}

ChartPlan chart(const std::string& scene, const std::vector<std::string>& methods,
                const std::vector<std::string>& overrides = {}) {
  return {.scene = read_scene(find_scene(scene), overrides),
          .methods = methods,
          .quick = true,
          .repeats = 1,
          .steps = 60,
          .drift_steps = 600};
}

class Study : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  Ledger ledger_{folder_.path() / "ledger.tsv", "test"};
};

TEST_F(Study, ErrorsFollowTolerancesAndOrders) {
  const ChartPlan plan = chart("freely_jointed", {"shake", "rattle", "newton", "lincs"}, {"build.chains=5"});
  run(work_jobs(plan, ledger_), ledger_);
  const Table work(work_csv(plan, ledger_));
  for (const std::string method : {"shake", "rattle", "newton"})
    for (const std::string tolerance : {"1e-4", "1e-6", "1e-8"}) {
      const double largest = work.number("max_rel_bond_error", {{"method", method}, {"value", tolerance}});
      EXPECT_LE(largest, std::stod(tolerance)) << method;
      if (method == "newton") continue;  // its last iteration overshoots by orders
      EXPECT_GT(largest, 0.5 * std::stod(tolerance)) << method;
    }
  double before = 1;
  for (const std::string order : {"2", "4", "8"}) {
    const double rms = work.number("rms_rel_bond_error", {{"parameter", "order"}, {"value", order}});
    EXPECT_LT(rms, before / 2) << order;
    before = rms;
  }
}

TEST_F(Study, ChartsTheSceneWithPairForcesInEveryPanel) {
  ChartPlan plan = chart("freely_jointed", {"newton"});
  plan.scene = read(kMelt);
  plan.steps = 4, plan.drift_steps = 20;
  const TemporaryFolder folder;
  const auto tables = [&](const std::string& file) {
    Ledger ledger(folder.path() / file, "test");
    run(chart_jobs(plan, ledger), ledger);
    return chart_tables(plan, ledger);
  };
  const auto names_of = [](const auto& found) {
    std::vector<std::string> names;
    for (const auto& [name, csv] : found) names.push_back(name);
    return names;
  };
  const auto all = tables("all");
  EXPECT_THAT(names_of(all),
              testing::ElementsAre("work", "drift", "order", "length", "precision", "failures"));
  for (const char* kind : {"double", "mixed"})
    EXPECT_GT(Table(all[4].second).number("step_us", {{"precision", kind}}), 0);
  plan.panels = {"drift"};
  EXPECT_THAT(names_of(tables("one")), testing::ElementsAre("work", "drift", "failures"));
  plan.scene = read_scene(find_scene("freely_jointed"), {"build.chains=2"});
  EXPECT_FALSE(plan.has("precision")) << "no pair forces";
}

// A chain that hangs at rest moves by rounding alone, which is no energy that blows up.
TEST_F(Study, WhatHangsAtRestDoesNotBlowUp) {
  const Scene scene = read(R"([build]
kind = "atoms"
atoms = [[0, 0, 0, 0], [0, -1, 0, 1], [0, -2, 0, 1], [0, -3, 0, 10]]
bonds = [[0, 1, 1], [1, 2, 1], [2, 3, 1]]
velocities = [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]
gravity_nm_ps2 = [0, -9.81, 0]
[run]
dt_fs = 1
)");
  EXPECT_EQ(try_setting(scene, setting_of("baumgarte"), {}).failure, "");
}

TEST_F(Study, TrajectoriesAreOfSecondOrder) {
  const ChartPlan plan =
      chart("freely_jointed", {"baumgarte", "feedforward", "rattle", "newton"}, {"build.chains=2"});
  run(order_jobs(plan), ledger_);
  for (const auto& method : plan.methods) EXPECT_NEAR(order_of(plan, ledger_, method), 2, 0.1) << method;
}

TEST_F(Study, RattlesEnergyIsFlat) {
  const ChartPlan plan = chart("freely_jointed", {"none", "rattle"}, {"build.chains=5"});
  run(work_jobs(plan, ledger_), ledger_);
  const Table drift(drift_csv(plan, ledger_));
  const double rattle = drift.number("drift_kj_mol_ns_dof", {{"method", "rattle"}, {"value", "1e-8"}});
  const double none = drift.number("drift_kj_mol_ns_dof", {{"method", "none"}});
  EXPECT_LT(std::abs(rattle), 2e-3 * std::abs(none));
  const double of_bonds = drift.number("constraint_drift_kj_mol_ns_dof", {{"method", "none"}});
  EXPECT_NEAR(of_bonds / none, 1, 1e-3);  // there are no other forces

  // The verdict's points are the tables' figures.
  const Table work(work_csv(plan, ledger_));
  const std::vector<ChartPoint> points = chart_points(plan, ledger_);
  ASSERT_EQ(points.size(), plan.settings().size());
  for (const ChartPoint& point : points) {
    if (point.name != "none" && point.name != "rattle (tolerance 1e-8)") continue;
    const std::string value = point.name == "none" ? "" : "1e-8";
    const auto figure = [&](const Table& table, const char* column) {
      return table.number(column, {{"method", point.method}, {"value", value}});
    };
    EXPECT_NEAR(point.error / figure(work, "rms_rel_bond_error"), 1, 1e-5);
    EXPECT_NEAR(point.cost.high / figure(work, "ns_per_bond_step_q3"), 1, 1e-3);
    EXPECT_EQ(point.keeps_energy, figure(drift, "drift_low") <= 0 && 0 <= figure(drift, "drift_high"))
        << point.name;
  }
}

// Beyond the propagator's limit gains are refused; well inside it nothing fails.
TEST_F(Study, ThePlaneEndsAtThePropagatorsLimit) {
  StabilityPlan plan{.methods = {}, .quick = true, .plane_steps = 100};
  plan.scenes.push_back(read_scene(find_scene("freely_jointed"), {"build.chains=2"}));
  run(plane_jobs(plan), ledger_);
  const Table plane(plane_csv(plan, ledger_));
  for (const std::string ah : {"0.1", "0.4"}) {
    const auto at = [&](const char* damping, const char* bh) {
      return plane.text("failure", {{"damping", damping}, {"alpha_h", ah}, {"beta_h", bh}});
    };
    EXPECT_EQ(at("centred", "1"), "");
    EXPECT_THAT(at("centred", "2.2"), ::testing::HasSubstr("unstable"));
    EXPECT_EQ(at("lagged", "1"), "");
    if (ah == "0.4") {
      EXPECT_THAT(at("lagged", "1.6"), ::testing::HasSubstr("unstable"));  // 2√0.6 = 1.55
    }
  }
}

// No force along a bond can hold a rotor that goes by more than its own length in a step.
TEST_F(Study, ARotorsLargestStep) {
  StabilityPlan plan{.methods = {"shake", "settle"}, .quick = true, .step_steps = 50};
  plan.scenes.push_back(read_scene(find_scene("diatomic")));
  run(step_jobs(plan), ledger_);
  const Table steps(steps_csv(plan, ledger_));
  const double largest = steps.number("largest_stable_fs", {{"method", "shake"}});
  EXPECT_GT(largest, 100 / 1.2);
  EXPECT_LE(largest, 100);
  EXPECT_EQ(steps.text("fails_as", {{"method", "shake"}}), "bond turned 90°");
  EXPECT_EQ(steps.number("largest_stable_fs", {{"method", "settle"}}), 0);
  EXPECT_EQ(steps.text("fails_as", {{"method", "settle"}}), "not water");
}

TEST(HardScenes, AreReadAndRun) {
  const auto scenes = list_scenes(scenes_folder() / "hard");
  EXPECT_GE(scenes.size(), 6u);
  for (const auto& [name, hard_on] : scenes) {
    Scene scene = read_scene(scenes_folder() / "hard" / (name + ".toml"));
    EXPECT_EQ(try_setting(scene, {"as shipped", "", "", {}}, {.steps = 20}).failure, "") << name;
    scene.run.dt_fs /= 4;
    EXPECT_EQ(try_setting(scene, setting_of("newton"), {.steps = 5}).failure, "") << name;
  }
}

// Below each error the cheapest that got through, and whom the quartiles do not tell from it; energy is kept where the
// drift's interval holds zero.
TEST(ChartVerdict, NamesTheCheapestOfEachKind) {
  using ::testing::AllOf, ::testing::EndsWith, ::testing::HasSubstr, ::testing::StartsWith;
  const std::vector<ChartPoint> points = {
      {"newton", "newton", 1e-12, {9.5, 11, 12}, true, 0.2},
      {"baumgarte", "baumgarte", 1e-5, {4, 5, 6}, false},
      {"feedforward", "feedforward (order 1)", 1e-7, {8, 9, 10}, false},
      {"feedforward", "feedforward (order 2)", 1e-8, {9, 9.5, 10}, true, 0.3},
      {"shake", "shake", 1e-13, {30, 31, 32}, false},
  };
  const auto lines = chart_verdict(points, 2);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_THAT(lines[0],
              AllOf(StartsWith("take feedforward (order 2), 9.5 ns a bond or newton, 11 ns a bond:"),
                    HasSubstr("below 1e-6"), HasSubstr("±0.3 kJ/mol/ns")));
  EXPECT_EQ(lines[1],
            "cheapest with rms error below 1e-4: baumgarte, 5 ns a bond; 1e-6: feedforward (order 1), 9 ns a "
            "bond or newton, 11 ns a bond; 1e-9: newton, 11 ns a bond");
  EXPECT_THAT(lines[2], EndsWith(": feedforward (order 2), newton"));
  const auto unknown = chart_verdict({{"newton", "newton", 1e-12, {9.5, 11, 12}, {}}}, 2);
  ASSERT_EQ(unknown.size(), 2u);
  EXPECT_THAT(unknown[0], HasSubstr("not known"));
  EXPECT_THAT(chart_verdict({points[1]}, 2)[0], StartsWith("take a shorter step"));
}

TEST(ChartVerdict, WarnsOfTimesTakenOnABusyMachine) {
  EXPECT_EQ(warn_of_load(1.4, 2), "");
  EXPECT_THAT(warn_of_load(1.6, 2),
              testing::HasSubstr("load 1.6 of 2 cores in the last minute): the times are noise"));
  EXPECT_EQ(warn_of_load(3.4, 4), "");
}

TEST(Ledger, GoesOnWhereItWasStopped) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "ledger.tsv";
  int runs = 0;
  const auto make = [&] {
    ++runs;
    Trial trial;
    trial.drift = 0.1 * runs;
    trial.constraint_drift = {0.2 * runs, 0.01};
    trial.rms_error = {1e-8, 1e-9};
    trial.failure = "a reason, with a comma";
    return trial;
  };
  Ledger(file, "study").once("a", make);
  std::ofstream(file, std::ios::app) << "b\t3\t4.2";  // killed while it wrote
  Ledger again(file, "study");
  EXPECT_EQ(again.once("a", make).drift, 0.1);
  EXPECT_EQ(again.at("a").failure, "a reason, with a comma");
  EXPECT_FALSE(again.has("b"));
  EXPECT_EQ(again.once("b", make).drift, 0.2);
  EXPECT_EQ(again.once("a", make).constraint_drift.value, 0.2);
  EXPECT_EQ(again.at("a").rms_error.error, 1e-9);
  EXPECT_EQ(Ledger(file, "study").at("b").drift, 0.2);
  EXPECT_THROW(Ledger(file, "another study"), InputError);
}

const std::vector<std::string> kFewWaters = {"build.molecules=64", "forcefield.cutoff_nm=0.55",
                                             "forcefield.switch_nm=0.5"};

// RATTLE's few sweeps correct positions without knowing them: its first five steps have 13 times the error that it comes to. A
// chart has what it comes to, however many steps are timed, and so have two runs of other lengths.
TEST_F(Study, ChartsTheErrorAtRestNotThatOfTheStart) {
  const Scene water = read_scene(find_scene("water"), kFewWaters);
  const Setting rattle = setting_of("rattle:sweeps=4");
  const Trial with_start = try_setting(water, rattle, {.steps = 40, .rows = 40});
  const Trial at_rest = try_setting(water, rattle, {.start = 40, .steps = 40, .rows = 40});
  const auto charted = [&](long steps, long drift_steps) {
    ChartPlan plan = chart("water", {"rattle:sweeps=4", "newton"}, kFewWaters);
    plan.steps = steps, plan.drift_steps = drift_steps;
    Ledger ledger(folder_.path() / fmt::format("{}-{}", steps, drift_steps), "test");
    run(work_jobs(plan, ledger), ledger);
    return Table(work_csv(plan, ledger));
  };
  const Table brief = charted(40, 400), timed_longer = charted(120, 400), longer = charted(40, 1200);
  for (const char* column : {"rms_rel_bond_error", "max_rel_bond_error"}) {
    const auto error = [&](const Table& table) {
      return table.number(column, {{"method", "rattle:sweeps=4"}});
    };
    EXPECT_LT(error(brief), 0.4 * (column[0] == 'r' ? with_start.rms_error.value : 4e-4)) << column;
    EXPECT_EQ(error(brief), error(timed_longer)) << column;
    EXPECT_NEAR(error(brief) / error(longer), 1, 0.2) << column;
  }
  EXPECT_LT(at_rest.rms_error.value, 0.4 * with_start.rms_error.value);
  EXPECT_NEAR(at_rest.rms_error.value / longer.number("rms_rel_bond_error", {{"method", "rattle:sweeps=4"}}),
              1, 0.25);
  EXPECT_EQ(longer.text("at_rest", {{"method", "rattle:sweeps=4"}}), "1");
  EXPECT_NE(longer.number("later_over_earlier", {{"method", "rattle:sweeps=4"}}), 1);
}

// A step at which a method runs is longer than one at which it keeps the energy.
TEST_F(Study, TellsStepsThatRunFromThoseThatKeepTheEnergy) {
  StabilityPlan plan{.methods = {"newton"}, .quick = true, .step_steps = 200};
  plan.scenes.push_back(read_scene(find_scene("water"), kFewWaters));
  run(step_jobs(plan), ledger_);
  const auto& [runs, kept] = largest_steps(ledger_, 0, "newton");
  EXPECT_GT(kept.figure, 0.5);
  EXPECT_LT(kept.figure, 0.9 * runs.figure);
  EXPECT_LE(std::abs(kept.drift), 0.1 * kept.kT + 3 * kept.drift_error);
  const Table steps(steps_csv(plan, ledger_));
  EXPECT_NEAR(steps.number("energy_kept_up_to_fs", {{"method", "newton"}}) / kept.figure, 1, 1e-3);
}

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
}  // namespace taut::study_tests
