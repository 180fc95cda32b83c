// The command as a user types it: what it prints, writes and returns.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "taut_command.hpp"
#include "temporary_folder.hpp"

namespace taut::app_tests {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

struct App : ::testing::Test {
  const TemporaryFolder folder;
};

TEST_F(App, RunsASceneAndSaysWhatItDoes) {
  const std::string text = said("run water --steps 20 --set run.log_every=10");
  EXPECT_THAT(text,
              HasSubstr("atoms 648   bonds 648   clusters 216   degrees of freedom 3·648 − 648 − 3 = 1293"));
  EXPECT_THAT(text, HasSubstr("method newton"));
  EXPECT_THAT(text, HasSubstr("energy drift"));
  EXPECT_THAT(text, HasSubstr("bond error"));
  EXPECT_THAT(text, HasSubstr("[bar]"));
  EXPECT_THAT(text, HasSubstr("216 molecules of 3 atoms: translation"));
  EXPECT_THAT(text, Not(HasSubstr(" left \x1b")));  // no progress line where nobody watches
}

TEST_F(App, WritesLogSummaryAndFinalState) {
  const fs::path out = folder.path() / "a" / "run";
  const std::string text =
      said("run chain --method newton --steps 40 --dt-fs 2 --set run.log_every=10 --out " + out.string());
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
  for (const auto& entry : fs::directory_iterator(out)) {
    if (entry.path().filename() == ".lock") continue;
    EXPECT_THAT(text.substr(text.rfind("wrote ")), HasSubstr(entry.path().string()));
  }
  for (const auto& entry : fs::directory_iterator(out)) EXPECT_NE(entry.path().extension(), ".part");
}

TEST_F(App, TellsWhereTheTimeWent) {
  const std::string text = said("run water --steps 20 --timings");
  EXPECT_THAT(text, HasSubstr("20 steps in "));
  for (const char* part : {"\n  pairs ", "\n  bonds ", "\n  rest ", "\n  all "})
    EXPECT_THAT(text, HasSubstr(part));
  EXPECT_THAT(text, Not(HasSubstr("thermostat")));
  EXPECT_THAT(taut("run water --steps 20").text, Not(HasSubstr("ms a step")));
  const auto summary = nlohmann::json::parse(taut("run water --steps 20 --timings --json").text);
  double percent = 0;
  for (const auto& part : summary["timings"]["parts"]) percent += part["percent"].get<double>();
  EXPECT_NEAR(percent, 100, 2);
  EXPECT_EQ(summary["timings"]["parts"]["pairs"]["calls"], 20);
  EXPECT_FALSE(nlohmann::json::parse(taut("run water --steps 20 --json").text).contains("timings"));
}

// Double precision and 1 fs for scenes; mixed precision, and 2 fs where all hydrogens are held, for what OpenMM
// prepared, unless the user or the run's folder says another.
TEST_F(App, OpenMMsSystemsRunInMixedPrecisionAtTwoFemtoseconds) {
  const std::string data = TAUT_SCENES "/../tests/data/tip3p-216.";
  const std::string files = "--openmm " + data + "system.xml " + data + "state.xml ";
  const auto out = [&](const char* name) { return " --out " + (folder.path() / name).string(); };
  EXPECT_THAT(taut("run water --steps 1").text,
              HasSubstr("double precision (change with --precision mixed)"));
  const auto first = taut("run " + files + "--steps 2" + out("mixed"));
  EXPECT_THAT(first.text, HasSubstr("mixed precision (change with --precision double)"));
  EXPECT_THAT(first.text, HasSubstr("2 steps of 2 fs"));
  EXPECT_THAT(taut("run " + files + "--steps 2 --dt-fs 1").text, HasSubstr("2 steps of 1 fs"));
  const std::string free = TAUT_SCENES "/../tests/data/every-force.";  // no bond holds its hydrogen
  EXPECT_THAT(taut("info --openmm " + free + "system.xml " + free + "state.xml").text,
              HasSubstr("1000 steps of 1 fs"));
  EXPECT_THAT(taut("run " + files + "--steps 2 --precision double" + out("double")).text,
              HasSubstr("double precision (change with --precision mixed)"));
  EXPECT_THAT(
      taut("info " + files).text,
      ::testing::ContainsRegex("forcefield.precision +\"mixed\" +default\n.*run.dt_fs +2 fs +default"));
  EXPECT_THAT(taut("resume " + (folder.path() / "mixed").string() + " --steps 2").text,
              HasSubstr("mixed precision"));
  for (const std::string name : {"mixed", "double"})
    for (const std::string& said : {std::string(" --steps 6"), " --steps 8 --dt-fs 2 --precision " + name}) {
      const auto [exit_code, text] = taut("run " + files + said + " --continue" + out(name.c_str()));
      EXPECT_EQ(exit_code, 0) << text;
      EXPECT_THAT(text, HasSubstr(name + " precision"));
    }
  const std::string refused =
      said("run " + files + "--steps 8 --precision double --continue" + out("mixed"), 2);
  EXPECT_THAT(refused, HasSubstr("forcefield.precision is \"mixed\" there, \"double\" here"));
}

struct BadInput {
  const char* arguments;
  const char* message;
};
const BadInput kBadInputs[] = {
    {"run", "expected a scene"},
    {"run nowhere", "taut: nowhere: no such file, and no scene of that name; expected one of"},
    {"run water --method ratle", "taut: --method ratle: there is no \"ratle\"; did you mean \"rattle\"?"},
    {"run water --set run.temprature_k=300", "temperature_k"},
    {"run water --set run.dt_fs=fast", "expected a number"},
    {"run water --set forcefield.cutoff_nm=1.2", "forcefield.cutoff_nm: 1.2 is over half the box"},
    {"run water --dt-fs -1", "--dt-fs -1: expected more than 0, got -1"},
    {"run water --steps -5", "--steps -5: expected at least 0, got -5"},
    {"run water --steps 1e30", "expected a whole number below 9.2e18, got 1e30"},
    {"run water --steps 2.5", "--steps: expected a whole number, got 2.5"},
    {"run -", "-: a scene is read from a file, not from standard input"},
    {"run /tmp", "/tmp: a folder, not a scene's file"},
    {"run /dev/null", "/dev/null: a pipe or a device, which can be read once only"},
    {"run chain --method settle", "not part of a three-site water"},
    {"run water --set method.tolerance=1e-15", "cannot be reached"},
    {"run water --method baumgarte --set method.gains=ded-beat", "dead-beat"},
    {"run water --method baumgarte --set method.beta_per_ps=1e5", "unstable"},
    {"chart water --methods ratle", "did you mean \"rattle\"?"},
    {"stability nowhere", "taut: nowhere: no such file, and no scene of that name"},
    {"chart freely_jointed --quick --methods settle", "no method to chart"},
#if TAUT_WITH_OPENMM_TWIN
    {"crosscheck pendulum", "OpenMM cannot express it"},
#endif
    {"run --openmm missing.xml missing.xml", "missing.xml: cannot be read"},
};

class BadInputs : public ::testing::TestWithParam<BadInput> {};
INSTANTIATE_TEST_SUITE_P(Kinds, BadInputs, ::testing::ValuesIn(kBadInputs),
                         [](const auto& test) { return "case" + std::to_string(test.index); });

// One line, exit code 2, and nothing left in the folder it was to write.
TEST_P(BadInputs, GetOneLineAndLeaveNothing) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  const std::string text = said(std::string(GetParam().arguments) + " --out " + out.string(), 2);
  EXPECT_EQ(lines(text), 1) << text;
  EXPECT_THAT(text, HasSubstr(GetParam().message));
  EXPECT_FALSE(fs::exists(out));
}

// One key, two values: neither is taken in silence.
TEST_F(App, AKeySaidTwiceIsRefused) {
  for (const char* twice :
       {"run pair --steps 5 --set run.steps=6", "run pair --method newton --set method.name=rattle",
        "run pair --set run.dt_fs=1 run.dt_fs=2", "calibrate pair --dt-fs 1 --set run.dt_fs=2",
        "chart pair --dt-fs 1 --set run.dt_fs=2", "stability pair --dt-fs 1 --set run.dt_fs=2",
        "crosscheck water --steps 5 --set run.steps=6", "run pair --set run.dt_fs=1 \"run={dt_fs=2}\""}) {
    const auto [exit_code, text] = taut(twice);
    EXPECT_EQ(exit_code, 2) << twice;
    EXPECT_EQ(lines(text), 1) << text;
    EXPECT_THAT(text, HasSubstr(" is said twice, as "));
  }
  EXPECT_THAT(taut("run pair --steps 5 --set run.steps=6").text,
              HasSubstr("run.steps is said twice, as --steps 5 and as --set run.steps=6"));
  EXPECT_EQ(taut("run pair --steps 5 --set run.steps=5 --dt-fs 2 --set run.dt_fs=2.0").exit_code, 0);
}

// From equilibration to production.
TEST_F(App, VelocitiesOfAStartAreKeptAndTheHeaderSaysSo) {
  const auto first = taut("run water --steps 10 --out " + folder.path().string());
  EXPECT_THAT(first.text, HasSubstr("velocities drawn at 298.15 K"));
  const std::string text = said("run water --steps 10 --set run.thermostat=langevin --set build.start=" +
                                (folder.path() / "final.start.toml").string());
  EXPECT_THAT(text, HasSubstr("velocities the start's"));
  EXPECT_THAT(taut("run pair --steps 10").text, HasSubstr("velocities none, at rest"));
}

// A simulation that fails says when, which bond and what to try, and keeps its log.
TEST_F(App, AFailedRunSaysWhyAndKeepsItsLog) {
  const std::string text = said("run water --dt-fs 20 --steps 1000 --out " + folder.path().string(), 1);
  EXPECT_THAT(text, HasSubstr("step "));
  EXPECT_THAT(text, HasSubstr("bond "));
  EXPECT_THAT(text, HasSubstr("largest force"));
  EXPECT_THAT(text, HasSubstr("try: "));
  EXPECT_TRUE(fs::exists(folder.path() / "log.csv"));
  EXPECT_FALSE(fs::exists(folder.path() / "summary.json"));
}

TEST_F(App, FilesAskedForWithoutAFolderAreRefused) {
  for (const char* key : {"run.trajectory_every", "run.checkpoint_every", "run.checkpoint_minutes"}) {
    const std::string text = said(std::string("run pair --set ") + key + "=10", 2);
    EXPECT_EQ(lines(text), 1) << text;
    EXPECT_THAT(text, HasSubstr(key));
    EXPECT_THAT(text, HasSubstr("--out"));
  }
}

// What could not be said was not done: exit 3. A run has written its files all the same.
TEST_F(App, AnOutputThatIsNotTakenIsOutside) {
  const std::string out = folder.path().string();
  const auto exit_code = [](const std::string& words) {
    return WEXITSTATUS(std::system((std::string(TAUT_BINARY) + " " + words + " >&- 2>/dev/null").c_str()));
  };
  EXPECT_EQ(exit_code("scenes"), 3);
  EXPECT_EQ(exit_code("run pair --steps 20 --set run.log_every=1 --out " + out), 3);
  EXPECT_TRUE(fs::exists(folder.path() / "summary.json"));
  EXPECT_EQ(lines(contents(folder.path() / "log.csv")), 22);
}

// The scenes are found from where the command is, or where the environment says; a file needs none of it.
TEST_F(App, ScenesAreFoundFromTheCommand) {
  const std::string share = (fs::path(TAUT_BINARY).parent_path() / "share" / "taut").string();
  fs::create_directory(folder.path() / "bin");
  const std::string moved = (folder.path() / "bin" / "taut").string();
  fs::copy_file(TAUT_BINARY, moved);
  const auto [exit_code, text] = taut("run pair --steps 1", "", moved);
  EXPECT_EQ(exit_code, 3);
  EXPECT_EQ(lines(text), 1) << text;
  EXPECT_THAT(text, HasSubstr((folder.path() / "share/taut/scenes").string()));
  EXPECT_EQ(taut("run " + share + "/scenes/pair.toml --steps 1", "", moved).exit_code, 0);
  EXPECT_EQ(taut("run pair --steps 1", "TAUT_SHARE=" + share, moved).exit_code, 0);
  EXPECT_THAT(taut("scenes", "TAUT_SHARE=/nowhere").text, HasSubstr("/nowhere/scenes is no folder"));
  fs::create_directories(folder.path() / "share/taut");
  fs::create_directory_symlink(share + "/scenes", folder.path() / "share/taut/scenes");
  EXPECT_EQ(taut("scenes", "", moved).text, taut("scenes").text);
  // a build or a package may replace the command while it runs
  const auto replaced = taut("3<" + moved + "; rm " + moved + "; /proc/self/fd/3 scenes", "", "exec");
  EXPECT_EQ(replaced.text, taut("scenes").text);
}

// The pipe's reader has gone: stopped as by a signal, with a checkpoint.
TEST_F(App, ARunNobodyReadsStopsAndCanGoOn) {
  const std::string out = (folder.path() / "run").string(), code = (folder.path() / "code").string();
  taut("methods >/dev/null; (" TAUT_BINARY " run pair --steps 100000000 --set run.log_every=1 --out " + out +
       "; echo $? >" + code + ") | head -3");
  EXPECT_EQ(contents(code), "141\n");
  const auto resumed = taut("resume " + out + " --set run.steps=0");
  EXPECT_THAT(resumed.text, ::testing::ContainsRegex("goes on from step [1-9]"));
}

}  // namespace
}  // namespace taut::app_tests
