// taut plot, and run and measure that draw, as a user types them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "measures/csv.hpp"
#include "short_runs.hpp"

namespace taut::plots_tests {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;
using json = nlohmann::json;
using tests::kShortRun;
using Plots = tests::ShortRuns;

// Every row is drawn once, as left out or as measured.
TEST_F(Plots, DrawWhatTheRuleOfEquilibrationLeavesOut) {
  undrawn.reset();
  said("run melt --steps 100 --set run.log_every=1 --quiet --out " + at + "run");
  const json measured = json::parse(said("measure --from auto --json --out " + at + "m " + at + "run"));
  const auto rows = csv_rows(contents(at + "m/equilibration.csv"));
  EXPECT_EQ(std::ssize(rows), 1 + 101);
  long count = 0;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    EXPECT_NE(rows[k][1].empty(), rows[k][2].empty()) << k;
    count += !rows[k][2].empty();
  }
  EXPECT_EQ(count, measured["rows"]);
  EXPECT_TRUE(std::filesystem::exists(at + "m/equilibration.png"));
}

// The bath's temperature beside the run's; tensions of the frames; atoms, bonds and walls of the first and last frame.
TEST_F(Plots, TheBathTheTensionsAndTheFrames) {
  said(
      "run slit --steps 40 --set run.log_every=20 run.trajectory_every=20 run.trajectory=h5md --quiet --plot "
      "--out " +
      at + "slit");
  const auto rows = csv_rows(contents(at + "slit/plot/run.csv"));
  std::vector<std::string> bath;
  std::vector<double> mean, largest;
  for (const auto& row : rows) {
    if (row[1] == "bath") bath.push_back(row[3]);
    if (row[0] == "bond tension [kJ/mol/nm]")
      (row[1] == "mean" ? mean : largest).push_back(std::stod(row[3]));
  }
  EXPECT_EQ(bath, (std::vector<std::string>{"300", "300", "300"}));
  ASSERT_EQ(mean.size(), 3u);
  ASSERT_EQ(largest.size(), 3u);
  for (int k = 0; k < 3; ++k) EXPECT_GT(largest[k], std::abs(mean[k]));
  std::map<std::string, int> count;
  for (const auto& row : page_table(at + "slit/plot", "First and last frame"))
    ++count[row[0] + ": " + row[1]];
  for (const std::string frame : {"first frame (z up)", "last frame (z up)"}) {
    EXPECT_EQ(count[frame + ": atom"], 240);
    EXPECT_EQ(count[frame + ": bond"], 216);
    EXPECT_EQ(count[frame + ": wall"], 2);
  }
}

// Walls, springs that move and biases are drawn and measured as the log has them.
TEST_F(Plots, ShowWhatASceneAddsToItsLog) {
  said("run slit --steps 400 --set run.log_every=4 --quiet --out " + at + "slit");
  const auto log = csv_rows(contents(at + "slit/log.csv"));
  const auto column = std::ranges::find(log[0], "Wall 1 Pressure (bar)") - log[0].begin();
  double sum = 0;
  for (std::size_t row = 1; row < log.size(); ++row) sum += std::stod(log[row][column]);
  const json measured = json::parse(said("measure --json " + at + "slit"));
  EXPECT_NEAR(measured["wall_1_pressure_bar"]["value"], sum / 101, 1e-6 * std::abs(sum));
  const auto panels = [&](const std::string& run) {
    std::set<std::string> names;
    for (const auto& row : csv_rows(contents(at + run + "/plot/run.csv"))) names.insert(row[0]);
    return names;
  };
  said("plot --quiet " + at + "slit");
  EXPECT_THAT(panels("slit"), IsSupersetOf({"pressure on wall 0 [bar]", "pressure on wall 1 [bar]"}));
  said("run held_chain --steps 200 --set run.log_every=2 bias.0.rate_nm_ps=0.1 --plot --quiet --out " + at +
       "held");
  EXPECT_THAT(panels("held"), IsSupersetOf({"steering work [kJ/mol]", "bias ends: distance [nm]"}));
}

// The account leaves out what the moving ends of springs bring, as the run's drift does: without a thermostat it is even.
TEST_F(Plots, TheAccountWithoutTheSteeringsWork) {
  folder.write("dragged.toml",
               "[molecule.bead]\natoms = [{name = \"B\", mass_u = 40}]\n"
               "steered = [[0, 1, 0, 0, 500]]\n[[place]]\nmolecule = \"bead\"\ncount = 1\n"
               "[run]\ndt_fs = 5\n");
  said("run " + at + "dragged.toml --steps 2000 --set run.log_every=2 --plot --quiet --out " + at + "run");
  double account = 0, work = 0;
  for (const auto& row : csv_rows(contents(at + "run/plot/run.csv"))) {
    if (row[1] == "energy but for heat and steering")
      account = std::max(account, std::abs(std::stod(row[3])));
    if (row[0] == "steering work [kJ/mol]") work = std::max(work, std::stod(row[3]));
  }
  EXPECT_GT(work, 50);  // up to 2 m v²
  EXPECT_GT(account, 0);
  EXPECT_LT(account, 1e-3 * work);
}

// A plot's page has what `taut measure --from auto` gives, of several runs laid over each other.
TEST_F(Plots, WhatIsMeasured) {
  undrawn.reset();
  for (const char* seed : {"1", "2"})
    said(kShortRun + std::string("run.trajectory_every=2 run.seed=") + seed + " --quiet --out " + at + seed);
  const json drawn = json::parse(said("plot --json " + at + "1"));
  EXPECT_EQ(drawn["measured"], json::array({json::parse(said("measure --from auto --json " + at + "1"))}));
  EXPECT_THAT(contents(at + "1/plot/report.html"),
              AllOf(HasSubstr("<details open>"), HasSubstr("⟨R_g²⟩"),
                    HasSubstr("⟨R(0)·R(t)⟩/⟨R²⟩ of chains, bands"), HasSubstr("equilibrated from there on")));
  EXPECT_THAT(said("plot --out " + at + "both " + at + "1 " + at + "2"),
              AllOf(HasSubstr("measured: " + at + "1"), HasSubstr("measured: " + at + "2")));
  std::set<std::string> curves;
  const std::string displacement = "2 runs: mean-square displacement of molecules, bands: standard errors";
  for (const auto& row : page_table(at + "both", displacement)) curves.insert(row[0]);
  EXPECT_EQ(curves, (std::set<std::string>{"run", "1", "2"}));
  EXPECT_EQ(page_table(at + "both", "Measured").size() % 2, 1u);  // each figure of both
}

// Of a long trajectory a plot reads frames evenly spaced, as many as are asked for at most.
TEST_F(Plots, SomeFramesOfManyOnly) {
  for (const char* kind : {"dcd", "h5md"}) {
    const std::string run = at + kind;
    // every fourth frame of the one run is a frame of the other
    for (const char* every : {"2", "8"})
      said(kShortRun + std::string("run.trajectory_every=") + every + " run.trajectory=" + kind +
           " --quiet --out " + run + every);
    json thinned = json::parse(said("plot --json --frames 26 " + run + "2"))["measured"][0];
    const json few = json::parse(said("plot --json " + run + "8"))["measured"][0];
    EXPECT_EQ(thinned["one_frame_of"], 4);
    EXPECT_FALSE(few.contains("one_frame_of"));
    for (const char* figure : {"frames", "interval_ps", "end_to_end_squared_nm2", "gyration_squared_nm2"})
      EXPECT_EQ(thinned[figure], few[figure]) << figure;
    EXPECT_EQ(json::parse(said("plot --overwrite --json --frames 0 " + run + "2"))["measured"][0]["frames"],
              101);
    EXPECT_THAT(said("plot --overwrite --frames 26 " + run + "2"), HasSubstr("of 4 frames one is read"));
    EXPECT_THAT(contents(run + "2/plot/report.html"), HasSubstr("Of 4 frames one is read"));
  }
  const auto rows = csv_rows(contents(at + "h5md2/plot/run.csv"));
  EXPECT_EQ(
      std::ranges::count_if(
          rows, [](const auto& row) { return row[0] == "bond tension [kJ/mol/nm]" && row[1] == "mean"; }),
      26);
  EXPECT_THAT(said("plot --frames -1 " + at + "dcd2", 2), HasSubstr("--frames"));
}

// Every column of the log that the run has becomes a curve, of each run one.
TEST_F(Plots, RunsOverEachOther) {
  undrawn.reset();
  EXPECT_THAT(said(kShortRun + std::string("--plot --out ") + at + "1"), HasSubstr("▁"));
  std::set<std::string> files;
  for (const auto& file : fs::directory_iterator(at + "1/plot"))
    files.insert(file.path().filename().string());
  EXPECT_EQ(files, (std::set<std::string>{"report.html", "run.csv", "run.png"}));
  EXPECT_THAT(said(kShortRun + std::string("--plot"), 2), HasSubstr("--out DIR"));
  said(kShortRun +
       std::string(
           "run.seed=2 run.thermostat=langevin 'run.temperature_k=[[0, 400], [1.2, 300]]' --quiet --out ") +
       at + "2");
  const json drawn = json::parse(said("plot --json --out " + at + "both " + at + "1 " + at + "2"));
  std::set<std::string> temperatures;
  for (const json& curve : drawn["curves"])
    if (curve["panel"] == "temperature [K]") temperatures.insert(curve["curve"]);
  EXPECT_EQ(temperatures, (std::set<std::string>{"1", "2", "2: bath"}));
  const auto rows = csv_rows(contents(at + "both/run.csv"));
  EXPECT_EQ(rows[0], (std::vector<std::string>{"panel", "curve", "t_ps", "value", "running_mean"}));
  const double from = drawn["measured"][1]["from_ps"];  // where the bath stays the same
  double sum = 0, measured = 0;
  for (const auto& row : rows)
    if (row[0] == "temperature [K]" && row[1] == "2") {
      ASSERT_EQ(row[4].empty(), std::stod(row[2]) < from - 1e-9) << "means are of the measured part alone";
      if (row[4].empty()) continue;
      sum += std::stod(row[3]), ++measured;
      EXPECT_NEAR(std::stod(row[4]), sum / measured, 1e-6 * sum / measured);
    }
  EXPECT_NEAR(sum / measured, drawn["measured"][1]["temperature_k"]["value"], 1e-6 * sum / measured);
  EXPECT_THAT(said("plot --out " + at + "both " + at + "1", 2), HasSubstr("--overwrite"));
  EXPECT_THAT(said("plot " + at + "absent", 2), HasSubstr("the folder of a run"));
  const Outcome bare = taut("plot --out " + at + "bare " + at + "1", "TAUT_PYTHON=/nowhere");
  EXPECT_EQ(bare.exit_code, 0) << bare.text;
  EXPECT_THAT(bare.text, AllOf(HasSubstr("python3-matplotlib"),
                               HasSubstr("the same command with --overwrite"), HasSubstr("█")));
}

// Runs of one name in two folders are told apart in every table.
TEST_F(Plots, RunsOfOneNameApart) {
  for (const char* run : {"a/run", "b/run"}) said(kShortRun + std::string("--quiet --out ") + at + run);
  said("plot --quiet --out " + at + "both " + at + "a/run " + at + "b/run/");
  EXPECT_THAT(contents(at + "both/run.csv"),
              AllOf(HasSubstr("a/run"), HasSubstr("b/run"), Not(HasSubstr(at))));
  std::set<std::string> runs;
  for (const auto& row : page_table(at + "both", "Temperatures")) runs.insert(row[0]);
  EXPECT_EQ(runs, (std::set<std::string>{"run", "a/run", "b/run"}));
}

// The temperatures of a run stand beside its bath's, if that is one.
TEST_F(Plots, TemperaturesBesideTheBaths) {
  const auto temperatures = [&](const std::string& name, const std::string& bath) {
    said(kShortRun + bath + " --plot --quiet --out " + at + name);
    std::string text;
    for (const auto& row : page_table(at + name + "/plot", "Temperatures"))
      text += row[0] + "," + row[1] + "," + row[2] + "\n";
    return text;
  };
  EXPECT_THAT(temperatures("a", "run.thermostat=langevin run.temperature_k=310"), EndsWith("\na,bath,310\n"));
  EXPECT_THAT(temperatures("b", "run.temperature_k=310"), Not(HasSubstr("bath")));
  EXPECT_THAT(temperatures("c", "run.thermostat=langevin 'run.temperature_k=[[0, 300], [1, 310]]'"),
              Not(HasSubstr("bath")));
}

}  // namespace
}  // namespace taut::plots_tests
