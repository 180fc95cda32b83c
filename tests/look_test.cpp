// measure and plot as a user types them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "measures/csv.hpp"
#include "taut_command.hpp"
#include "temporary_folder.hpp"

namespace taut::look_tests {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;
using json = nlohmann::json;

constexpr const char* kShortRun = "run freely_jointed --steps 200 --set build.chains=10 run.log_every=2 ";

struct Look : ::testing::Test {
  const TemporaryFolder folder;
  std::optional<Undrawn> undrawn{std::in_place};  // unless a test looks at a picture
  const std::string at = folder.path().string() + "/";
};

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
  said(brownian + "2000 run.trajectory_every=2 --quiet --out " + at + "1");
  for (const std::string every : {"2", "8"})
    said(brownian + "8000 run.trajectory_every=" + every + " build.start=" + at +
         "1/final.start.toml --quiet --out " + at + every);
  const auto joined = [&](const std::string& second) {
    return json::parse(said("measure --join --json " + at + "1 " + at + second));
  };
  const json even = joined("2"), uneven = joined("8");
  EXPECT_EQ(even["frames"], 5001);
  EXPECT_EQ(even["frames_followed"], 5001);
  EXPECT_EQ(uneven["frames"], 2001);
  EXPECT_EQ(uneven["frames_followed"], 1251);
  EXPECT_NEAR(uneven["interval_ps"], 0.08, 1e-6);
  const double d = even["diffusion_nm2_per_ps"]["value"];
  EXPECT_NEAR(uneven["diffusion_nm2_per_ps"]["value"], d, 0.1 * d) << "the same motion";
  const double r2 = even["end_to_end_squared_nm2"]["value"];
  EXPECT_NEAR(uneven["end_to_end_squared_nm2"]["value"], r2, 0.02 * r2);
  EXPECT_THAT(said("measure --join " + at + "1 " + at + "8"),
              AllOf(HasSubstr("2001 frames of 200 atoms, 0.02 to 0.08 ps apart"),
                    HasSubstr("of 1251 evenly spaced frames, 0.08 ps apart, from 0 to 100 ps")));

  said("resume " + at + "1 --steps 18000 --quiet --set run.log_every=20 run.trajectory_every=0");
  const auto log = csv_rows(contents(at + "1/log.csv"));
  const auto column = std::ranges::find(log[0], "Temperature (K)") - log[0].begin();
  double before = 0, after = 0;
  for (std::size_t row = 1; row < log.size(); ++row)
    (row <= 1001 ? before : after) += std::stod(log[row][static_cast<std::size_t>(column)]);
  EXPECT_NEAR(json::parse(said("measure --json " + at + "1"))["temperature_k"]["value"],
              0.1 * before / 1001 + 0.9 * after / 900, 0.3);
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

// Every row is drawn once, as left out or as measured.
TEST_F(Look, DrawsWhatTheRuleOfEquilibrationLeavesOut) {
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
TEST_F(Look, PlotsTheBathTheTensionsAndTheFrames) {
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
TEST_F(Look, ShowsWhatASceneAddsToItsLog) {
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
TEST_F(Look, PlotsTheAccountWithoutTheSteeringsWork) {
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

// A plot's page has what `taut measure --from auto` gives, of several runs laid over each other.
TEST_F(Look, PlotsWhatIsMeasured) {
  undrawn.reset();
  for (const char* seed : {"1", "2"})
    said(kShortRun + std::string("run.trajectory_every=2 run.seed=") + seed + " --quiet --out " + at + seed);
  const json drawn = json::parse(said("plot --json " + at + "1"));
  EXPECT_EQ(drawn["measured"], json::array({json::parse(said("measure --from auto --json " + at + "1"))}));
  EXPECT_THAT(contents(at + "1/plot/report.html"), AllOf(HasSubstr("<details open>"), HasSubstr("⟨R_g²⟩"),
                                                         HasSubstr(">⟨R(0)·R(t)⟩/⟨R²⟩ of chains</text>"),
                                                         HasSubstr("equilibrated from there on")));
  EXPECT_THAT(said("plot --out " + at + "both " + at + "1 " + at + "2"),
              AllOf(HasSubstr("measured: " + at + "1"), HasSubstr("measured: " + at + "2")));
  std::set<std::string> curves;
  const std::string displacement = "2 runs: mean-square displacement of molecules, bands: standard errors";
  for (const auto& row : page_table(at + "both", displacement)) curves.insert(row[0]);
  EXPECT_EQ(curves, (std::set<std::string>{"run", "1", "2"}));
  EXPECT_EQ(page_table(at + "both", "Measured").size() % 2, 1u);  // each figure of both
}

// Of a long trajectory a plot reads frames evenly spaced, as many as are asked for at most.
TEST_F(Look, PlotsSomeFramesOfManyOnly) {
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
TEST_F(Look, PlotsRunsOverEachOther) {
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
  EXPECT_NEAR(from, 1.2, 1e-9);
  double sum = 0;
  int count = 0, measured = 0;
  for (const auto& row : rows)
    if (row[0] == "temperature [K]" && row[1] == "2") {
      ++count;
      ASSERT_EQ(row[4].empty(), std::stod(row[2]) < from - 1e-9) << "means are of the measured part alone";
      if (row[4].empty()) continue;
      sum += std::stod(row[3]);
      ++measured;
      EXPECT_NEAR(std::stod(row[4]), sum / measured, 1e-6 * sum / measured);
    }
  EXPECT_EQ(count, 101);
  EXPECT_NEAR(sum / measured, drawn["measured"][1]["temperature_k"]["value"], 1e-6 * sum / measured);
  EXPECT_THAT(said("plot --out " + at + "both " + at + "1", 2), HasSubstr("--overwrite"));
  EXPECT_THAT(said("plot " + at + "absent", 2), HasSubstr("the folder of a run"));
  const Outcome bare = taut("plot --out " + at + "bare " + at + "1", "TAUT_PYTHON=/nowhere");
  EXPECT_EQ(bare.exit_code, 0) << bare.text;
  EXPECT_THAT(bare.text, AllOf(HasSubstr("python3-matplotlib"),
                               HasSubstr("the same command with --overwrite"), HasSubstr("█")));
}

// Runs of one name in two folders are told apart in every table.
TEST_F(Look, PlotsRunsOfOneNameApart) {
  for (const char* run : {"a/run", "b/run"}) said(kShortRun + std::string("--quiet --out ") + at + run);
  said("plot --quiet --out " + at + "both " + at + "a/run " + at + "b/run/");
  EXPECT_THAT(contents(at + "both/run.csv"),
              AllOf(HasSubstr("a/run"), HasSubstr("b/run"), Not(HasSubstr(at))));
  std::set<std::string> runs;
  for (const auto& row : page_table(at + "both", "Temperatures")) runs.insert(row[0]);
  EXPECT_EQ(runs, (std::set<std::string>{"run", "a/run", "b/run"}));
}

// Curves whose names differ behind a comma stay two.
TEST_F(Look, PlotsRunsWithCommasInTheirNames) {
  undrawn.reset();
  const std::string one = "'" + at + "x, 1'", two = "'" + at + "x, 2'";
  for (const std::string& run : {one, two}) said(kShortRun + std::string("--quiet --out ") + run);
  said("plot --quiet --format svg --out '" + at + "both' " + one + " " + two);
  EXPECT_THAT(contents((folder.path() / "both/run.svg").string()),
              AllOf(HasSubstr(">x, 1</text>"), HasSubstr(">x, 2</text>")));
}

// The temperatures of a run stand beside its bath's, if that is one.
TEST_F(Look, PlotsTemperaturesBesideTheBaths) {
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
