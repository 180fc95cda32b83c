// The command as a user types it: what it prints, writes and returns.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "systems/studies/csv.hpp"
#include "temporary_folder.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

struct Outcome {
  int exit_code;
  std::string text;  // both streams
};

// `environment`: as a shell takes it before a command, "PATH=/nowhere".
Outcome taut(const std::string& arguments, const std::string& environment = "") {
  std::FILE* pipe = popen((environment + " " + TAUT_BINARY + " " + arguments + " 2>&1").c_str(), "r");
  Outcome outcome{};
  std::array<char, 4096> buffer;
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
    outcome.text.append(buffer.data(), n);
  outcome.exit_code = WEXITSTATUS(pclose(pipe));
  return outcome;
}

std::string contents(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

// A report's text, its entities undone.
std::string page(const fs::path& folder) {
  std::string text = contents(folder / "report.html");
  for (const auto& [entity, character] :
       {std::pair("&#39;", '\''), {"&quot;", '"'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&amp;", '&'}})
    for (std::size_t at = 0; (at = text.find(entity, at)) != text.npos; ++at)
      text.replace(at, std::string_view(entity).size(), 1, character);
  return text;
}

int lines(const std::string& text) {
  return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

TEST(App, RunsASceneAndSaysWhatItDoes) {
  const auto [exit_code, text] = taut("run water --steps 20 --set run.log_every=10");
  EXPECT_EQ(exit_code, 0) << text;
  EXPECT_THAT(text,
              HasSubstr("atoms 648   bonds 648   clusters 216   degrees of freedom 3·648 − 648 − 3 = 1293"));
  EXPECT_THAT(text, HasSubstr("method rattle"));
  EXPECT_THAT(text, HasSubstr("energy drift"));
  EXPECT_THAT(text, HasSubstr("bond error"));
  EXPECT_THAT(text, HasSubstr("P [bar]"));
  EXPECT_THAT(text, HasSubstr("216 molecules of 3 atoms: translation"));
  EXPECT_THAT(text, Not(HasSubstr(" left \x1b")));  // no progress line where nobody watches
}

TEST(App, WritesLogSummaryAndFinalState) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "a" / "run";
  const auto [exit_code, text] =
      taut("run chain --method newton --steps 40 --dt-fs 2 --set run.log_every=10 --out " + out.string());
  ASSERT_EQ(exit_code, 0) << text;
  const std::string log = contents(out / "log.csv");
  EXPECT_EQ(lines(log), 6);  // header, start and four rows
  EXPECT_THAT(log, ::testing::StartsWith("#\"Step\",\"Time (ps)\",\"Potential Energy (kJ/mole)\""));
  const auto summary = nlohmann::json::parse(contents(out / "summary.json"));
  for (const char* key :
       {"scene", "method", "atoms", "bonds", "dof", "steps", "dt_fs", "us_per_step", "constraint_us_per_step",
        "ns_per_day", "max_rel_bond_error", "rms_rel_bond_error", "energy_drift_kj_mol_ns_dof",
        "temperature_k", "potential_kj_mol", "total_kj_mol", "converged", "temperatures_k", "pressure_bar"})
    EXPECT_TRUE(summary.contains(key)) << key;
  EXPECT_EQ(summary["method"], "newton");
  EXPECT_EQ(summary["steps"], 40);
  EXPECT_EQ(summary["dt_fs"], 2);
  EXPECT_LT(summary["max_rel_bond_error"], 1e-10);
  EXPECT_TRUE(fs::exists(out / "final.start.toml"));
  for (const auto& entry : fs::directory_iterator(out)) EXPECT_NE(entry.path().extension(), ".part");
}

TEST(App, GoesOnFromAFinalState) {
  const TemporaryFolder folder;
  ASSERT_EQ(taut("run water --steps 10 --out " + folder.path().string()).exit_code, 0);
  const auto [exit_code, text] = taut("run water --steps 10 --set run.temperature_k=0 --set build.start=" +
                                      (folder.path() / "final.start.toml").string());
  EXPECT_EQ(exit_code, 0) << text;
}

TEST(App, RepeatsToTheLastBit) {
  const TemporaryFolder one, two;
  for (const auto* folder : {&one, &two})
    ASSERT_EQ(taut("run melt --method baumgarte --steps 50 --out " + folder->path().string()).exit_code, 0);
  EXPECT_EQ(contents(one.path() / "final.start.toml"), contents(two.path() / "final.start.toml"));
}

TEST(App, ListsMethodsAndScenes) {
  const auto methods = taut("methods");
  EXPECT_EQ(methods.exit_code, 0);
  for (const char* name :
       {"none", "penalty", "baumgarte", "feedforward", "shake", "rattle", "newton", "lincs", "settle"})
    EXPECT_THAT(methods.text, HasSubstr(std::string(name) + " "));
  const auto scenes = taut("scenes");
  EXPECT_EQ(scenes.exit_code, 0);
  EXPECT_THAT(scenes.text, HasSubstr("pendulum"));
}

TEST(App, CalibratesAndWritesJson) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "calibration.json";
  const auto [exit_code, text] =
      taut("calibrate freely_jointed --sweeps 2 --set build.chains=20 --json " + file.string());
  ASSERT_EQ(exit_code, 0) << text;
  const auto json = nlohmann::json::parse(contents(file));
  for (const char* key : {"reduction_rattle", "alpha_per_ps", "beta_per_ps", "reduction_predicted",
                          "reduction_measured", "floor_predicted", "floor_measured"})
    EXPECT_TRUE(json.contains(key)) << key;
}

// `taut run` with the settings that calibrate gives shows the floor that it measured: from step 50, over 160.
TEST(App, WhatCalibrateExportsRunsAsItMeasured) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "calibration.json", out = folder.path() / "run";
  const auto calibrated =
      taut("calibrate water --sweeps 1 --dt-fs 1 --set run.seed=5 --json " + file.string());
  ASSERT_EQ(calibrated.exit_code, 0) << calibrated.text;
  const auto json = nlohmann::json::parse(contents(file));
  const std::string command = json["run"];
  EXPECT_THAT(calibrated.text, HasSubstr(command));
  EXPECT_THAT(command, HasSubstr("method.passes=2"));
  EXPECT_EQ(json["method"]["passes"], 2);
  const auto ran = taut(command.substr(5) + " --steps 210 --set run.log_every=1 --out " + out.string());
  ASSERT_EQ(ran.exit_code, 0) << ran.text;
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
TEST(App, ChartsWithAReportThatNeedsNothingElse) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "chart";
  const auto [exit_code, text] = taut(
      "chart freely_jointed --quick --methods newton settle --set build.chains=2 'run.seed = 3' "
      "--drift-steps 100 --out " +
      out.string());
  ASSERT_EQ(exit_code, 0) << text;
  EXPECT_THAT(text, HasSubstr("not part of a three-site water"));  // failed, and listed
  for (const char* name : {"work", "drift", "order", "length"})
    for (const char* kind : {".csv", ".gp"}) EXPECT_TRUE(fs::exists(out / (std::string(name) + kind)));
  const std::string report = page(out);
  EXPECT_THAT(report,
              HasSubstr("<code>taut chart freely_jointed --methods newton settle --set build.chains=2 "
                        "'run.seed = 3' --drift-steps 100 --quick --out " +
                        out.string() + "</code>"));
  EXPECT_THAT(report, Not(HasSubstr("href=\"http")));
  EXPECT_THAT(report, Not(HasSubstr("src=")));
  EXPECT_FALSE(fs::exists(out / "unfinished.tsv"));
}

TEST(App, StabilitySaysHowEachMethodFails) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "stability";
  const auto [exit_code, text] =
      taut("stability diatomic --quick --steps 100 --dt-fs 2.5 --methods shake settle --out " + out.string());
  ASSERT_EQ(exit_code, 0) << text;
  EXPECT_THAT(text, HasSubstr("the bond turned by 90° in one step"));
  for (const char* name : {"plane.csv", "plane.gp", "steps.csv", "steps.gp", "limits.csv", "report.html"})
    EXPECT_TRUE(fs::exists(out / name)) << name;
  EXPECT_THAT(
      page(out),
      HasSubstr("<code>taut stability diatomic --methods shake settle --dt-fs 2.5 --steps 100 --quick "
                "--out " +
                out.string() + "</code>"));
}

// Whatever the folder is called: pictures are drawn, and the report's command can be typed again.
TEST(App, TheCommandInAReportCanBeTyped) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "our 'first' $HOME";
  const auto first = taut("chart diatomic --quick --methods newton --set 'run.seed = 3' --out \"" +
                          folder.path().string() + "/our 'first' \\$HOME\"");
  ASSERT_EQ(first.exit_code, 0) << first.text;
  EXPECT_TRUE(fs::exists(out / "work.png"));
  const std::string report = page(out);
  const auto begin = report.find("<code>taut ") + 11;
  const std::string command = report.substr(begin, report.find("</code>") - begin);
  fs::remove_all(out);
  const auto again = taut(command);
  EXPECT_EQ(again.exit_code, 0) << command << "\n" << again.text;
  EXPECT_THAT(page(out), HasSubstr("<code>taut " + command + "</code>"));
}

// A scene of some name: what is in it is text to the shell, to gnuplot, to a table and to a page.
std::string scene_named(const fs::path& folder, const std::string& name) {
  const fs::path file = folder / (name + ".toml");
  fs::copy_file(fs::path(TAUT_SCENES) / "diatomic.toml", file);
  std::string quoted = "'";
  for (const char c : file.string()) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

class HostileNames : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Of, HostileNames,
                         ::testing::Values("a`touch x`'\"\\n$(touch y)", "a\nb\tc'.system(\"touch x\").'",
                                           "<script>x<&amp;%s%n@x{:b ^2}#\\", "1,2;\"3\"\"\",\u00b5"));

TEST_P(HostileNames, AreTextEverywhere) {
  const TemporaryFolder folder;
  const std::string scene = scene_named(folder.path(), GetParam()), at = " --out " + folder.path().string();
  for (const auto& [command, out, picture] :
       {std::tuple{"chart " + scene + " --quick --methods newton none --drift-steps 100", "/chart", "work"},
        {"stability " + scene + " --quick --steps 20 --methods shake", "/stability", "steps"}}) {
    const fs::path files = folder.path().string() + out;
    const auto [exit_code, text] = taut(command + at + out);
    EXPECT_EQ(exit_code, 0) << text;
    EXPECT_TRUE(fs::exists(files / (std::string(picture) + ".png"))) << text;
    EXPECT_FALSE(fs::exists(files / "x") || fs::exists(files / "y")) << "a command was run";
    EXPECT_FALSE(fs::exists("x") || fs::exists("y")) << "a command was run";
    EXPECT_THAT(contents(files / "report.html"), Not(HasSubstr("<script")));
    EXPECT_FALSE(fs::exists(files / "unfinished.tsv"));
  }
  const auto rows = csv_rows(contents(folder.path() / "stability" / "steps.csv"));
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1].size(), rows[0].size());
  std::string name = GetParam();
  for (char& c : name) c = c == '"' ? '\'' : c < ' ' && c > 0 ? ' ' : c;
  EXPECT_EQ(rows[1][0], name);
}

// Whatever gnuplot does, only what is there is said to be written.
struct Gnuplot {
  const char *name, *script;  // empty: there is none
  int exit_code;
  const char* says;
};
class Gnuplots : public ::testing::TestWithParam<Gnuplot> {};
INSTANTIATE_TEST_SUITE_P(
    That, Gnuplots,
    ::testing::Values(Gnuplot{"IsNotThere", "", 0, "gnuplot is not installed"},
                      Gnuplot{"Fails", "echo no >&2; exit 1", 3, "work.gnuplot.log"},
                      Gnuplot{"DrawsNothing", "exit 0", 3, "gnuplot could not draw work, drift"},
                      Gnuplot{"DrawsHalf", ": > ${1%.gp}.svg", 3, "gnuplot could not draw work, drift"}),
    [](const auto& test) { return test.param.name; });

TEST_P(Gnuplots, AreNotTakenAtTheirWord) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "chart", bin = folder.path() / "bin";
  fs::create_directory(bin);
  if (*GetParam().script) {
    std::ofstream(bin / "gnuplot") << "#!/bin/sh\n" << GetParam().script << "\n";
    fs::permissions(bin / "gnuplot", fs::perms::owner_all);
  }
  const auto [exit_code, text] =
      taut("chart diatomic --quick --methods newton --drift-steps 100 --out " + out.string(),
           "PATH=" + bin.string());
  EXPECT_EQ(exit_code, GetParam().exit_code) << text;
  EXPECT_THAT(text, HasSubstr(GetParam().says));
  const std::string line = text.substr(text.find("wrote into"),
                                       text.find('\n', text.find("wrote into")) - text.find("wrote into"));
  for (const char* name : {"work", "drift", "order", "length"})
    for (const char* kind : {".csv", ".gp", ".svg", ".png"}) {
      const std::string file = std::string(name) + kind;
      EXPECT_EQ(fs::exists(out / file), line.find(file) != line.npos) << file << ": " << line;
    }
  EXPECT_THAT(line, HasSubstr("report.html"));
  EXPECT_THAT(contents(out / "report.html"), HasSubstr("newton"));
}

struct BadInput {
  const char* arguments;
  const char* message;
};
class BadInputs : public ::testing::TestWithParam<BadInput> {};

// One line, exit code 2, and nothing left in the folder it was to write.
TEST_P(BadInputs, GetOneLineAndLeaveNothing) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  const auto [exit_code, text] = taut(std::string(GetParam().arguments) + " --out " + out.string());
  EXPECT_EQ(exit_code, 2) << text;
  EXPECT_EQ(lines(text), 1) << text;
  EXPECT_THAT(text, HasSubstr(GetParam().message));
  EXPECT_FALSE(fs::exists(out));
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, BadInputs,
    ::testing::Values(BadInput{"run", "expected a scene"}, BadInput{"run nowhere", "nowhere"},
                      BadInput{"run water --method ratle", "did you mean \"rattle\"?"},
                      BadInput{"run water --set run.temprature_k=300", "temperature_k"},
                      BadInput{"run water --set run.dt_fs=fast", "expected a number"},
                      BadInput{"run water --set forcefield.cutoff_nm=1.2", "cutoff"},
                      BadInput{"run water --dt-fs -1", "dt_fs"}, BadInput{"run water --steps -5", "steps"},
                      BadInput{"run chain --method settle", "not part of a three-site water"},
                      BadInput{"run water --set method.tolerance=1e-15", "cannot be reached"},
                      BadInput{"run water --method baumgarte --set method.gains=ded-beat", "dead-beat"},
                      BadInput{"run water --method baumgarte --set method.beta_per_ps=1e5", "unstable"},
                      BadInput{"chart water --methods ratle", "did you mean \"rattle\"?"},
                      BadInput{"stability nowhere", "nowhere"},
                      BadInput{"run --openmm missing.xml missing.xml", "missing.xml: cannot be read"}),
    [](const auto& test) { return "case" + std::to_string(test.index); });

// A simulation that fails says when, which bond and what to try, and keeps its log.
TEST(App, AFailedRunSaysWhyAndKeepsItsLog) {
  const TemporaryFolder folder;
  const auto [exit_code, text] = taut("run water --dt-fs 20 --steps 1000 --out " + folder.path().string());
  EXPECT_EQ(exit_code, 1) << text;
  EXPECT_THAT(text, HasSubstr("step "));
  EXPECT_THAT(text, HasSubstr("bond "));
  EXPECT_THAT(text, HasSubstr("largest force"));
  EXPECT_THAT(text, HasSubstr("try: "));
  EXPECT_TRUE(fs::exists(folder.path() / "log.csv"));
  EXPECT_FALSE(fs::exists(folder.path() / "summary.json"));
}

TEST(App, FilesAskedForWithoutAFolderAreRefused) {
  for (const char* key : {"run.trajectory_every", "run.checkpoint_every"}) {
    const auto [exit_code, text] = taut(std::string("run pair --set ") + key + "=10");
    EXPECT_EQ(exit_code, 2) << text;
    EXPECT_EQ(lines(text), 1) << text;
    EXPECT_THAT(text, HasSubstr(key));
    EXPECT_THAT(text, HasSubstr("--out"));
  }
}

TEST(App, AFolderThatCannotBeMadeIsOutside) {
  const auto [exit_code, text] = taut("run pair --out /proc/taut");
  EXPECT_EQ(exit_code, 3);
  EXPECT_EQ(lines(text), 1) << text;
  EXPECT_THAT(text, HasSubstr("/proc/taut"));
}

}  // namespace
}  // namespace taut
