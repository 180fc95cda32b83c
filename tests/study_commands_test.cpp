// calibrate, chart, stability and crosscheck as a user types them: what they print, write and return.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "measures/csv.hpp"
#include "taut_command.hpp"
#include "temporary_folder.hpp"

namespace taut::study_commands_tests {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

struct StudyCommands : ::testing::Test {
  const TemporaryFolder folder;
  std::optional<Undrawn> undrawn{std::in_place};  // unless a test looks at a picture
};

TEST_F(StudyCommands, CalibratesAndWritesJson) {
  const fs::path file = folder.path() / "calibration.json";
  const auto [exit_code, text] =
      taut("calibrate freely_jointed --sweeps 2 --set build.chains=20 --json " + file.string());
  ASSERT_EQ(exit_code, 0) << text;
  const auto json = nlohmann::json::parse(contents(file));
  for (const char* key : {"reduction_rattle", "alpha_per_ps", "beta_per_ps", "reduction_predicted",
                          "reduction_measured", "floor_predicted", "floor_measured"})
    EXPECT_TRUE(json.contains(key)) << key;
  ASSERT_EQ(json["table"].size(), 4u);
  EXPECT_EQ(json["table"][0]["method"], "rattle:sweeps=2");
  const std::string take = json["take"];  // the command that the table leads to runs, and is not doubted
  EXPECT_THAT(text, HasSubstr(take));
  const std::string ran = said(take.substr(5) + " --steps 2500");
  EXPECT_THAT(ran, Not(HasSubstr("in doubt")));
}

// `taut run` with the settings that calibrate gives shows the floor that it measured: from step 50, over 160.
TEST_F(StudyCommands, WhatCalibrateExportsRunsAsItMeasured) {
  const fs::path file = folder.path() / "calibration.json", out = folder.path() / "run";
  const std::string calibrated =
      said("calibrate water --sweeps 1 --dt-fs 1 --steps 40 --set run.seed=5 --json " + file.string());
  const auto json = nlohmann::json::parse(contents(file));
  const std::string command = json["run"];
  EXPECT_THAT(calibrated, HasSubstr(command));
  EXPECT_THAT(command, HasSubstr(",reduction="));
  said(command.substr(5) + " --steps 210 --set run.log_every=1 --out " + out.string());
  std::istringstream log(contents(out / "log.csv"));
  std::string line;
  std::getline(log, line);
  double squares = 0;
  while (std::getline(log, line)) {
    std::istringstream cells(line);
    std::vector<double> row;
    for (std::string cell; row.size() < 9 && std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    if (row[0] > 50) squares += row[8] * row[8];
  }
  EXPECT_NEAR(std::sqrt(squares / 160) / json["floor_measured"].get<double>(), 1, 1e-3);
}

// The report shows everything by itself; data and script stay beside the pictures; the ledger goes.
TEST_F(StudyCommands, ChartsWithAReportThatNeedsNothingElse) {
  const fs::path out = folder.path() / "chart";
  const auto [exit_code, text] = taut(
      "chart freely_jointed --quick --methods newton settle --set build.chains=2 'run.seed = 3' "
      "--drift-steps 100 --out " +
          out.string(),
      "TAUT_PROGRESS_S=0");
  ASSERT_EQ(exit_code, 0) << text;
  EXPECT_THAT(text, HasSubstr(" trials after 0:00:0"));  // a row now and then, where there is no terminal
  EXPECT_THAT(text, HasSubstr("\ncheapest with rms error below 1e-4: newton"));
  const std::string listed = text.substr(text.find(" failed, not drawn"));  // a line for each reason
  EXPECT_THAT(
      listed,
      HasSubstr(" more (work, drift, order, length): refused: method settle: bond 0 (0-1) is not part "
                "of a three-site water"));
  EXPECT_EQ(listed.find("three-site water"), listed.rfind("three-site water"));
  for (const char* name : {"work", "drift", "order", "length"})
    EXPECT_TRUE(fs::exists(out / (std::string(name) + ".csv")));
  const std::string report = page(out);
  EXPECT_THAT(report,
              HasSubstr("<code>taut chart freely_jointed --methods newton settle --set build.chains=2 "
                        "'run.seed = 3' --drift-steps 100 --quick --out " +
                        out.string() + "</code>"));
  EXPECT_THAT(report, HasSubstr("<b>cheapest with rms error below 1e-4: newton"));
  EXPECT_THAT(report, Not(HasSubstr("href=\"http")));
  EXPECT_THAT(report, Not(HasSubstr("src=")));
  EXPECT_FALSE(fs::exists(out / "unfinished.tsv"));
}

TEST_F(StudyCommands, StabilitySaysHowEachMethodFails) {
  const fs::path out = folder.path() / "stability";
  const std::string gains = "--alpha-h 0.1 0.3 --beta-h 1 1.4 ";
  const auto [exit_code, text] = taut("stability diatomic --quick --steps 100 " + gains +
                                      "--dt-fs 2.5 --methods shake settle --out " + out.string());
  ASSERT_EQ(exit_code, 0) << text;
  EXPECT_THAT(text, HasSubstr("16 points in the plane"));  // of four dampings
  EXPECT_THAT(contents(out / "plane.csv"), HasSubstr("centred,0.3,1.4,"));
  EXPECT_THAT(text, HasSubstr("the bond turned by 90° in one step"));
  for (const char* name : {"plane.csv", "steps.csv", "limits.csv", "report.html"})
    EXPECT_TRUE(fs::exists(out / name)) << name;
  EXPECT_THAT(page(out),
              HasSubstr("<code>taut stability diatomic --methods shake settle --dt-fs 2.5 --steps 100 " +
                        gains + "--quick --out " + out.string() + "</code>"));
  const std::string refused = said("stability diatomic --beta-h 1 --out " + out.string() + "2", 2);
  EXPECT_THAT(refused, HasSubstr("--beta-h: expected at least two numbers"));
}

// What OpenMM wrote is studied as a scene is, and the commands in reports and lines say so.
TEST_F(StudyCommands, TakeASystemOfOpenMMs) {
  const std::string prefix = TAUT_SCENES "/../tests/data/dna-hbonds.";
  const std::string files = "--openmm " + prefix + "system.xml.gz " + prefix + "state.xml.gz";
  const std::string plane = "stability " + files + " --methods baumgarte --dt-fs 2 --steps 5 --quick --out " +
                            (folder.path() / "plane").string();
  const std::string stability = said(plane);
  EXPECT_THAT(stability, HasSubstr("dna-hbonds: 80 points"));
  EXPECT_THAT(page(folder.path() / "plane"), HasSubstr("<code>taut " + plane + "</code>"));
  const std::string chart =
      said("chart " + files + " --quick --methods newton --steps 2 --drift-steps 20 --out " +
           (folder.path() / "chart").string());
  const std::string calibration = said("calibrate " + files + " --dt-fs 1 --steps 0");
  EXPECT_THAT(calibration, HasSubstr("taut run " + files + " --method baumgarte:gains="));
  for (const char* command : {"stability", "chart", "calibrate"})
    for (const std::string& about : {std::string(), "water " + files}) {
      const std::string text = said(std::string(command) + " " + about, 2);
      EXPECT_EQ(lines(text), 1) << text;
      EXPECT_THAT(text, HasSubstr("expected a scene, or --openmm system.xml state.xml"));
    }
}

// Whatever the folder is called: pictures are drawn, and the report's command can be typed again.
TEST_F(StudyCommands, TheCommandInAReportCanBeTyped) {
  undrawn.reset();
  const fs::path out = folder.path() / "our 'first' $HOME";
  said("chart diatomic --quick --methods newton --set 'run.dt_fs = 3' --out \"" + folder.path().string() +
       "/our 'first' \\$HOME\"");
  EXPECT_TRUE(fs::exists(out / "work.png"));
  const std::string report = page(out);
  const auto begin = report.find("<code>taut ") + 11;
  const std::string command = report.substr(begin, report.find("</code>") - begin);
  fs::remove_all(out);
  const auto again = taut(command);
  EXPECT_EQ(again.exit_code, 0) << command << "\n" << again.text;
  EXPECT_THAT(page(out), HasSubstr("<code>taut " + command + "</code>"));
}

// A file that is there is replaced only where that is asked for.
TEST_F(StudyCommands, ReplaceNoFileUnasked) {
  const std::string prefix = (folder.path() / "a").string();
  for (const auto& [command, file] :
       {std::pair("calibrate diatomic --json " + prefix + ".json", prefix + ".json"),
        {"crosscheck diatomic --steps 2 --methods newton --speed-seconds 0 --export " + prefix,
         prefix + ".state.xml"}}) {
    std::ofstream(file) << "mine";
    const std::string refused = said(command, 2);
    EXPECT_EQ(lines(refused), 1) << refused;
    EXPECT_THAT(refused, HasSubstr(file + ": is there already; --overwrite replaces it"));
    EXPECT_EQ(contents(file), "mine");
    EXPECT_EQ(taut(command + " --overwrite").exit_code, 0);
    EXPECT_NE(contents(file), "mine");
  }
}

// A folder holds one study: another is refused, and moved aside where that is asked for; nothing is lost.
TEST_F(StudyCommands, AFolderHoldsOneStudy) {
  const std::string out = (folder.path() / "out").string();
  const std::string chart = "chart diatomic --quick --methods newton --drift-steps 100 --out " + out;
  ASSERT_EQ(taut(chart).exit_code, 0);
  std::ofstream(out + "/mine.txt") << "mine";
  const std::string before = contents(out + "/work.csv");
  for (const std::string& other :
       {chart, "stability diatomic --quick --methods shake --steps 20 --out " + out}) {
    const std::string text = said(other, 2);
    EXPECT_EQ(lines(text), 1) << text;
    EXPECT_THAT(text, HasSubstr("--overwrite"));
    EXPECT_EQ(contents(out + "/work.csv"), before);
  }
  const std::string text =
      said("stability diatomic --quick --methods shake --steps 20 --overwrite --out " + out);
  EXPECT_THAT(text, HasSubstr("what was there is kept in " + fs::canonical(out).string() + ".1"));
  EXPECT_EQ(contents(out + ".1/work.csv"), before);
  EXPECT_TRUE(fs::exists(out + ".1/report.html"));
  EXPECT_FALSE(fs::exists(out + "/work.csv"));
  EXPECT_EQ(contents(out + "/mine.txt"), "mine");
  EXPECT_THAT(page(out), Not(HasSubstr("--overwrite")));
}

// What is left out of a scene, or without effect, is said.
TEST_F(StudyCommands, SayWhatTheyPassOver) {
  const std::string thermostat = " --set run.thermostat=langevin run.temperature_k=300 run.minimise=true";
  const auto chart = taut("chart pair --quick --methods newton none --drift-steps 100 --out " +
                          (folder.path() / "chart").string() + thermostat);
  const auto stability = taut("stability diatomic --quick --steps 20 --out " +
                              (folder.path() / "stability").string() + thermostat);
  const auto calibration = taut("calibrate diatomic" + thermostat);
  for (const auto& [exit_code, text] : {chart, stability, calibration}) {
    EXPECT_EQ(exit_code, 0) << text;
    EXPECT_THAT(text, HasSubstr("its thermostat (langevin) is left out"));
    EXPECT_THAT(text, HasSubstr("minimised in"));
  }
  for (const char* note : {"note: quick, so rough", "note: no intervals of the drift"})
    EXPECT_THAT(chart.text, HasSubstr(note));
  EXPECT_THAT(stability.text, HasSubstr("of 80 gains failed or were refused"));
  EXPECT_THAT(contents(folder.path() / "stability" / "steps.csv"), HasSubstr(",feedforward,"));  // of all
  for (const char* folder_name : {"chart", "stability"})
    EXPECT_THAT(page(folder.path() / folder_name), HasSubstr("its thermostat (langevin) is left out"));
  for (const char* command : {"chart", "stability", "calibrate", "crosscheck"})
    for (const char* key : {"method.tolerance=1e-3", "run.log_every=7", "run.trajectory_every=7"}) {
      const std::string text = said(std::string(command) + " pair --set " + key, 2);
      EXPECT_EQ(lines(text), 1) << text;
      EXPECT_THAT(text, HasSubstr(std::string(key) + ": no effect"));
    }
}

#if TAUT_WITH_OPENMM_TWIN

class CrosscheckCommand : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  fs::path out_ = folder_.path() / "out";
  std::string command_ =
      "crosscheck diatomic --steps 40 --methods newton baumgarte:gains=dead-beat --speed-seconds 0 "
      "--agreement-nm "
      "1e-9 --out " +
      out_.string();
};

// The whole: verdicts, figures, samples and pictures, of a scene with a thermostat, which is said to be left
// out.
TEST_F(CrosscheckCommand, WritesVerdictsSamplesAndPictures) {
  const std::string text = said(command_ + " --set run.thermostat=langevin run.temperature_k=300");
  EXPECT_THAT(text, HasSubstr("its thermostat (langevin) is left out"));
  const auto json = nlohmann::json::parse(contents(out_ / "crosscheck.json"));
  EXPECT_EQ(json["scene"], "diatomic");
  EXPECT_EQ(json["steps"], 40);
  EXPECT_THAT(json["notes"].dump(), HasSubstr("thermostat"));
  EXPECT_LT(json["start"]["largest_force_difference_kj_mol_nm"], 1e-9);
  std::map<std::string, std::string> findings;
  for (const auto& v : json["verdicts"]) findings[v["who"]] = v["finding"];
  EXPECT_EQ(findings["start"], "agrees");
  EXPECT_EQ(findings["newton"], "agrees");
  EXPECT_EQ(findings["baumgarte:gains=dead-beat"], "agrees");
  std::map<std::string, nlohmann::json> runs;
  for (const auto& run : json["runs"]) runs[run["name"]] = run;
  EXPECT_EQ(runs["newton"]["failure"], "");
  EXPECT_LT(runs["newton"]["most_apart_nm"], 1e-10);

  EXPECT_EQ(csv_rows(contents(out_ / "crosscheck.csv")).size(), 1 + 41 * runs.size());
  for (const char* file : {"crosscheck.csv", "crosscheck.png", "report.html"}) {
    EXPECT_TRUE(fs::exists(out_ / file)) << file;
    EXPECT_THAT(text, HasSubstr(file));
  }
  for (const char* part : {"class=charts", "Verdicts", "taut crosscheck "})
    EXPECT_THAT(page(out_), HasSubstr(part));
  for (const char* run : {"newton", "openmm verlet", "baumgarte:gains=dead-beat"})
    EXPECT_THAT(page(out_), HasSubstr(std::string(">") + run + "<"));
}

// A folder that takes no more files costs no text.
TEST_F(CrosscheckCommand, KeepsWhatItMeasured) {
  fs::create_directory(out_);
  fs::create_symlink("/dev/full", out_ / "crosscheck.json.part");
  const std::string text = said(command_, 3);
  EXPECT_THAT(
      text, AllOf(HasSubstr("newton                   agrees"), HasSubstr("crosscheck.json: cannot write")));
}

// A run that failed is the command's failure, after all is printed and written.
TEST_F(CrosscheckCommand, FailsWhereARunFailed) {
  const std::string text = said(
      "crosscheck diatomic --steps 5 --methods settle newton --speed-seconds 0 --out " + out_.string(), 1);
  EXPECT_THAT(text, AllOf(HasSubstr("\nfailed: settle: "), HasSubstr("newton "), HasSubstr("report.html")));
  EXPECT_THAT(nlohmann::json::parse(contents(out_ / "crosscheck.json"))["verdict"].get<std::string>(),
              HasSubstr("failed: settle"));
}

#endif

}  // namespace
}  // namespace taut::study_commands_tests
