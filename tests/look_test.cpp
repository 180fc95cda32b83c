// taut measure as a user types it, and what logs hold.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "measures/csv.hpp"
#include "short_runs.hpp"

namespace taut::look_tests {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using json = nlohmann::json;
using tests::kShortRun;
using Look = tests::ShortRuns;

// Means over seeds: the mean of the runs' means, with the larger of the two errors.
TEST_F(Look, MeasuresSeedsTogether) {
  for (const char* seed : {"1", "2", "3"})
    said(kShortRun + std::string("run.seed=") + seed + " --quiet --out " + at + seed);
  const std::string runs = at + "1 " + at + "2 " + at + "3 ";
  const json all = json::parse(said("measure " + runs + "--json --from 0.5 --out " + at + "measured"));
  const json& t = all["mean"]["temperature_k"];
  double mean = 0;
  for (const json& run : all["runs"]) {
    EXPECT_NEAR(run["from_ps"], 0.5, 1e-9);
    mean += run["temperature_k"]["value"].get<double>() / 3;
  }
  EXPECT_EQ(all["runs"].size(), 3u);
  EXPECT_NEAR(t["value"], mean, 1e-9);
  EXPECT_EQ(t["error"], std::max(t["error_by_seeds"].get<double>(), t["error_by_blocks"].get<double>()));
  EXPECT_GT(t["error_by_seeds"].get<double>(), 0);
  EXPECT_TRUE(fs::exists(at + "measured/each_run.csv"));
  EXPECT_THAT(said("measure " + runs), HasSubstr("mean of 3 runs"));
  EXPECT_THAT(said("measure " + at + "1 " + at + "1"), HasSubstr("the same seed"));
  said("run pair --steps 5 --quiet --out " + at + "pair");
  EXPECT_THAT(said("measure " + at + "1 " + at + "pair", 2), HasSubstr("runs of one scene"));
}

// A second segment that begins where the first ends is one run with it.
TEST_F(Look, MeasuresSegmentsAsOneRun) {
  said(kShortRun + std::string("run.trajectory_every=2 --quiet --out ") + at + "1");
  said(kShortRun + std::string("run.trajectory_every=2 run.trajectory=h5md build.start=") + at +
       "1/final.start.toml --quiet --out " + at + "2");
  const json one = json::parse(said("measure --json " + at + "1"));
  const json both = json::parse(said("measure --join --json " + at + "1 " + at + "2"));
  EXPECT_EQ(one["rows"], 101);
  EXPECT_EQ(both["rows"], 201);
  EXPECT_EQ(both["frames"], 201);
  EXPECT_EQ(json::parse(said("measure --join --last 1 --json " + at + "1 " + at + "2"))["rows"], 51);
}

// A run that went on with rows and frames four times as far apart: its last part alone, and joined to one that has them all
// along.
TEST_F(Look, TakesTheTimesOfRowsAndFrames) {
  const std::string brownian =
      "run freely_jointed --set build.chains=10 run.log_every=2 run.thermostat=langevin "
      "run.temperature_k=300 run.friction_per_ps=50 run.steps=";
  said(brownian + "200 run.trajectory_every=2 --quiet --out " + at + "1");
  for (const std::string every : {"2", "8"})
    said(brownian + "800 run.trajectory_every=" + every + " build.start=" + at +
         "1/final.start.toml --quiet --out " + at + every);
  const auto joined = [&](const std::string& second) {
    return json::parse(said("measure --join --json " + at + "1 " + at + second));
  };
  const json even = joined("2"), uneven = joined("8");
  EXPECT_EQ(even["frames"], 501);
  EXPECT_EQ(even["frames_followed"], 501);
  EXPECT_EQ(uneven["frames"], 201);
  EXPECT_EQ(uneven["frames_followed"], 126);
  EXPECT_NEAR(uneven["interval_ps"], 0.08, 1e-6);
  const double d = even["diffusion_nm2_per_ps"]["value"];
  EXPECT_NEAR(uneven["diffusion_nm2_per_ps"]["value"], d, 0.15 * d) << "the same motion";
  const double r2 = even["end_to_end_squared_nm2"]["value"];
  EXPECT_NEAR(uneven["end_to_end_squared_nm2"]["value"], r2, 0.02 * r2);
  EXPECT_THAT(said("measure --join " + at + "1 " + at + "8"),
              AllOf(HasSubstr("201 frames of 200 atoms, 0.02 to 0.08 ps apart"),
                    HasSubstr("of 126 evenly spaced frames, 0.08 ps apart, from 0 to 10 ps")));

  said("resume " + at + "1 --steps 1800 --quiet --set run.log_every=20 run.trajectory_every=0");
  const auto log = csv_rows(contents(at + "1/log.csv"));
  const auto column = std::ranges::find(log[0], "Temperature (K)") - log[0].begin();
  double before = 0, after = 0;
  for (std::size_t row = 1; row < log.size(); ++row)
    (row <= 101 ? before : after) += std::stod(log[row][static_cast<std::size_t>(column)]);
  EXPECT_NEAR(json::parse(said("measure --json " + at + "1"))["temperature_k"]["value"],
              0.1 * before / 101 + 0.9 * after / 90, 0.3);
}

// Beads of 1 nm have their first neighbours at 1.1 nm: as far as three shells are seen, not a length that suits water.
TEST_F(Look, SeesAsFarAsTheSystemIsCoarse) {
  said("run melt --steps 60 --set run.log_every=20 run.trajectory_every=20 --quiet --out " + at + "melt");
  const json g = json::parse(said("measure --json " + at + "melt"))["distances"];
  const auto height = [](const json& point) { return point[1].get<double>(); };
  const double at_peak = (*std::ranges::max_element(g, {}, height))[0];
  EXPECT_GT(at_peak, 1.02);
  EXPECT_LT(at_peak, 1.15);
  EXPECT_NEAR(g.back()[0], 3.16, 0.01) << "three times (1176.47 nm³/1000)^⅓";
  EXPECT_THAT(said("measure " + at + "melt"), HasSubstr("up to 3.17 nm: highest "));
}

// Doubts that a run ended with are the measurement's, too.
TEST_F(Look, KeepsTheDoubtsOfRuns) {
  const std::string one_sweep =
      "freely_jointed --steps 40 --dt-fs 40 --set build.chains=10 run.log_every=2 "
      "method.name=shake method.sweeps=1 ";
  const std::string run = said("run " + one_sweep + " --out " + at + "1");
  const std::string doubt = "in doubt: the constraints heat by ";
  ASSERT_THAT(run, HasSubstr(doubt));
  const auto begin = run.find(doubt);
  const std::string line = run.substr(begin, run.find('\n', begin) - begin);
  EXPECT_THAT(said("measure " + at + "1"), HasSubstr(line));
  EXPECT_THAT(json::parse(said("measure --json " + at + "1"))["doubts"][0].get<std::string>(),
              line.substr(std::string("in doubt: ").size()));
  EXPECT_THAT(said("scan " + one_sweep + "--seeds 2 --out " + at + "scan"),
              HasSubstr("in doubt: " + at + "scan/002: the constraints heat by "));
}

TEST_F(Look, MeasureRefusesWhatItCannotDo) {
  const std::string run = (folder.path() / "run").string();
  said(kShortRun + std::string("--quiet --out ") + run);
  EXPECT_THAT(said("measure --from soon " + run, 2), HasSubstr("expected a time in ps, or auto"));
  EXPECT_THAT(said("measure --from 1e3 " + run, 2), HasSubstr("the log ends at 2 ps"));
  EXPECT_THAT(said("measure --from 1 --last 1 " + run, 2), HasSubstr("one of them"));
  EXPECT_THAT(said("measure --from auto " + run), HasSubstr("Chodera"));
  EXPECT_THAT(said("measure --viscosity 1 " + run, 2), HasSubstr("run.trajectory_every"));
}

// What a bath that still changes does to a run is not equilibrated.
TEST_F(Look, MeasuresFromWhereTheBathStaysTheSame) {
  const auto window = [&](const std::string& name, const std::string& rows) {
    said(kShortRun + std::string("run.thermostat=langevin 'run.temperature_k=") + rows + "' --quiet --out " +
         at + name);
    return said("measure --from auto " + at + name);
  };
  EXPECT_THAT(
      window("cooled", "[[0, 400], [1.2, 300]]"),
      AllOf(HasSubstr("from 1.2 to 2 ps"), HasSubstr("the bath's temperature is the same from there on")));
  EXPECT_THAT(window("cooling", "[[0, 400], [2, 300]]"),
              AllOf(HasSubstr("Chodera"), HasSubstr("the bath's temperature changes in it")));
}

// The page's scene, pulled five times as fast: the work is the free energy, 7.79 kJ/mol a chain, and a little more. Chains
// that feel no wall would do -14.9 kJ/mol.
TEST_F(Look, PullsAnEndPastAWall) {
  const std::string page = contents(std::string(TAUT_SCENES) + "/../docs/worked_examples.md");
  const std::string begin = "```toml\n";
  const auto block = page.find(begin, page.find("### Past a wall\n"));
  ASSERT_NE(block, std::string::npos);
  const auto from = block + begin.size();
  folder.write("past.toml", page.substr(from, page.find("```", from) - from));
  said("run " + at + "past.toml --method feedforward --steps 10000 --set " +
       "'run.pull_factor=[[0, 0], [20, 0], [100, 1]]' --quiet --out " + at + "run");
  const auto log = csv_rows(contents(at + "run/log.csv"));
  const auto column = std::ranges::find(log[0], "Steering Work (kJ/mole)") - log[0].begin();
  ASSERT_LT(column, std::ssize(log[0]));
  const double work = std::stod(log.back()[column]) / 100;
  EXPECT_GT(work, 7.79 - 0.5);
  EXPECT_LT(work, 7.79 + 1.5);
}

// A log has the bath's temperature whether it changes or not, and a cell for it where the thermostat is taken away.
TEST_F(Look, LogsTheTemperatureOfABathThatChanges) {
  const std::string run =
      "run freely_jointed --steps 20 --set build.chains=5 run.log_every=10 run.thermostat=langevin ";
  const auto table = [&](const std::string& name) { return csv_rows(contents(at + name + "/log.csv")); };
  const std::string rows = "'run.temperature_k=[[0, 300], [0.4, 400]]'";
  EXPECT_THAT(said(run + rows + " --out " + at + "a"),
              HasSubstr("thermostat at 300 K at 0 ps, 400 K at 0.4 ps,"));
  said("resume " + at + "a --steps 20 --set run.temperature_k=350");
  ASSERT_EQ(table("a").size(), 6u);
  EXPECT_EQ(table("a")[0].back(), "Bath Temperature (K)");
  for (std::size_t row = 1; row < 6; ++row)
    EXPECT_EQ(table("a")[row].back(), (std::vector<std::string>{"300", "325", "350", "350", "350"})[row - 1]);
  said(run + "run.temperature_k=300 --out " + at + "b");
  said("resume " + at + "b --steps 20 --set " + rows);
  EXPECT_EQ(table("b")[0], table("a")[0]);
  EXPECT_EQ(table("b")[1].back(), "300");
  said("run freely_jointed --steps 20 --set build.chains=5 run.log_every=10 --out " + at + "c");
  EXPECT_EQ(table("c")[0], table("a")[0]);
  EXPECT_EQ(table("c")[1].back(), "");
  EXPECT_THAT(said("resume " + at + "b --steps 20 --set 'run.temperature_k=[[0, 300], [1, 0]]'", 2),
              HasSubstr("run.temperature_k[1]: expected a temperature above 0"));
  EXPECT_THAT(said("info freely_jointed --set run.thermostat=langevin " + rows),
              HasSubstr("[[0, 300], [0.4, 400]] K"));
}

}  // namespace
}  // namespace taut::look_tests
