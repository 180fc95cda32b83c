// The curves of `taut chart` and `taut stability` move as theory says, read from the CSV they are drawn from.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "base/errors.hpp"
#include "scene_text.hpp"
#include "simulation/simulation.hpp"
#include "studies/chart_study.hpp"
#include "studies/chart_verdict.hpp"
#include "studies/stability_study.hpp"
#include "systems/scene/scene_file.hpp"
#include "temporary_folder.hpp"

namespace taut::study_tests {
namespace {

// Rows by column name, as text.
class Table {
 public:
  explicit Table(const std::string& csv) {
    std::istringstream in(csv);
    std::string line;
    std::getline(in, line);
    header_ = cells(line);
    while (std::getline(in, line)) rows_.push_back(cells(line));
  }

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
  static std::vector<std::string> cells(const std::string& line) {
    std::vector<std::string> all(1);
    bool inside = false;
    for (const char c : line)
      if (c == '"')
        inside = !inside;
      else if (c == ',' && !inside)
        all.emplace_back();
      else
        all.back() += c;
    return all;
  }
  std::size_t at(const std::string& column) const {
    return static_cast<std::size_t>(std::ranges::find(header_, column) - header_.begin());
  }

  std::vector<std::string> header_;
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
  const std::vector<std::string> panels = {"work", "drift", "order", "length", "precision"};
  const auto names_of = [](const auto& tables) {
    std::vector<std::string> names;
    for (const auto& [name, csv] : tables) names.push_back(name);
    return names;
  };
  ChartPlan plan = chart("freely_jointed", {"newton"});
  plan.scene = read(kMelt);
  const TemporaryFolder folder;
  plan.steps = 4, plan.drift_steps = 20;
  for (const std::string& panel : panels) {
    SCOPED_TRACE(panel);
    plan.panels = {panel};
    Ledger ledger(folder.path() / panel, "test");
    run(chart_jobs(plan, ledger), ledger);
    std::vector<std::string> expected = {panel, "failures"};
    if (panel == "drift") expected.insert(expected.begin(), "work");
    EXPECT_EQ(names_of(chart_tables(plan, ledger)), expected);
  }
  plan.panels = {panels.begin(), panels.end()};
  run(chart_jobs(plan, ledger_), ledger_);
  const auto tables = chart_tables(plan, ledger_);
  EXPECT_THAT(names_of(tables),
              testing::ElementsAre("work", "drift", "order", "length", "precision", "failures"));
  const Table precision(tables[4].second);
  for (const char* kind : {"double", "mixed"})
    EXPECT_GT(precision.number("step_us", {{"precision", kind}}), 0);
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
  for (const char* method : {"newton", "baumgarte", "feedforward"})
    EXPECT_EQ(try_setting(scene, setting_of(method), {}).failure, "");
}

// A rotor turning by θ = 0.1 a step settles at θ⁴/8, and at h⁴ of it at shorter steps.
TEST_F(Study, BaumgartesFloorIsThatOfARotor) {
  const ChartPlan plan =
      chart("diatomic", {"baumgarte"}, {"method.name=baumgarte", "method.damping=centred"});
  run(work_jobs(plan, ledger_), ledger_);
  run(order_jobs(plan), ledger_);
  const Table work(work_csv(plan, ledger_)), order(order_csv(plan, ledger_));
  const double floor = 0.1 * 0.1 * 0.1 * 0.1 / 8;
  EXPECT_NEAR(work.number("rms_rel_bond_error", {{"value", "dead-beat"}}) / floor, 1, 0.05);
  const auto largest = [&](const char* dt) { return order.number("max_rel_bond_error", {{"dt_fs", dt}}); };
  EXPECT_NEAR(largest("10") / largest("5"), 16, 1);
  EXPECT_NEAR(largest("5") / largest("2.5"), 16, 1);
}

TEST_F(Study, TrajectoriesAreOfSecondOrder) {
  const ChartPlan plan =
      chart("freely_jointed", {"baumgarte", "feedforward", "rattle", "newton"}, {"build.chains=2"});
  run(order_jobs(plan), ledger_);
  for (const auto& method : plan.methods) EXPECT_NEAR(order_of(plan, ledger_, method), 2, 0.1) << method;
}

// What implicit damping adds to a pendulum's drift: as αh, as h³ and as 1/(βh)²; what centred damping adds is
// small.
TEST_F(Study, ImplicitDampingDriftsAsPredicted) {
  const auto plane = [&](const char* dt_fs, long steps, const std::string& file) {
    StabilityPlan plan{.methods = {}, .quick = true, .plane_steps = steps};
    plan.scenes.push_back(read_scene(find_scene("pendulum"), {std::string("run.dt_fs=") + dt_fs}));
    Ledger ledger(folder_.path() / file, "test");
    run(plane_jobs(plan), ledger);
    return Table(plane_csv(plan, ledger));
  };
  const Table coarse = plane("10", 1000, "coarse"), fine = plane("5", 2000, "fine");
  const auto added = [](const Table& t, const char* damping, const char* ah, const char* bh) {
    const auto drift = [&](const char* at) {
      return t.number("drift_kj_mol_ns_dof", {{"damping", damping}, {"alpha_h", at}, {"beta_h", bh}});
    };
    return drift(ah) - drift("0.05");
  };
  const double all = added(coarse, "implicit", "0.2", "1");
  EXPECT_GT(all, 0);
  EXPECT_NEAR(added(coarse, "implicit", "0.4", "1") / all, 0.35 / 0.15, 0.15);
  EXPECT_NEAR(all / added(fine, "implicit", "0.2", "1"), 8, 1);
  EXPECT_NEAR(all / added(coarse, "implicit", "0.2", "1.6"), 1.6 * 1.6, 0.4);
  EXPECT_LT(std::abs(added(coarse, "centred", "0.2", "1")), 0.05 * all);
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

}  // namespace
}  // namespace taut::study_tests
