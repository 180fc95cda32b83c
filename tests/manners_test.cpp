// The command explains itself: help, info, lists, what it says of typing errors, completions and the man
// page.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "base/threads.hpp"
#include "base/usable_cores.hpp"
#include "taut_command.hpp"
#include "temporary_folder.hpp"

namespace taut::manners_tests {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Manners, Version) {
  EXPECT_THAT(said("--version"), ContainsRegex("^taut [0-9]+\\.[0-9]+\n$"));
}

TEST(Manners, AKeyIsExplained) {
  EXPECT_EQ(said("help run.dt_fs"), "run.dt_fs = 1 fs\n    length of a step; number, more than 0\n");
  EXPECT_EQ(taut("help run.friction_per_ps", "COLUMNS=80").text,
            "run.friction_per_ps = 1 1/ps\n    friction of Langevin's thermostat; number, at least 0; counts "
            "only with\n"
            "    run.thermostat = \"langevin\"\n");
  EXPECT_THAT(said("help method.gains"),
              AllOf(HasSubstr("one of "), HasSubstr("dead-beat"), HasSubstr("baumgarte")));
  EXPECT_THAT(said("help build.density_g_cm3"), HasSubstr("g/cm³"));
  EXPECT_THAT(said("help method.rattle"),
              AllOf(HasSubstr("method.max_sweeps"), Not(HasSubstr("method.gains"))));
  EXPECT_THAT(said("help build.water"), AllOf(HasSubstr("build.model"), Not(HasSubstr("build.beads"))));
  EXPECT_THAT(said("help forcefield"), HasSubstr("forcefield.pme_order = 5"));
  EXPECT_THAT(said("help place.0.count"), HasSubstr("place.count\n"));
  EXPECT_THAT(said("help molecule.decane.units"), HasSubstr("molecule.NAME.units = 1\n"));
  EXPECT_THAT(said("help resume"), HasSubstr("--yes"));
  EXPECT_THAT(said("help run"), AllOf(HasSubstr("run.barostat"), HasSubstr("taut run --help")));
  EXPECT_THAT(said("help run.dt_sf", 2), EndsWith("did you mean \"run.dt_fs\"?\n"));
  EXPECT_EQ(said("help dt_fs"), said("help run.dt_fs"));
  const std::string sections =
      "atom, molecule, place, pair, wall, bias, motion, build, forcefield, run, method, start";
  EXPECT_THAT(taut("help", "COLUMNS=400").text, HasSubstr("a section of them: " + sections));
  EXPECT_THAT(said("help zzzzzzzz", 2), HasSubstr("sections: " + sections));
  EXPECT_THAT(said("help rope"), AllOf(HasSubstr("molecule.NAME.at_most"), Not(HasSubstr("impropers"))));
  EXPECT_THAT(said("help spce"), HasSubstr("place.molecule"));
  const json key = json::parse(said("help run.dt_fs --json"));
  EXPECT_EQ(key[0]["unit"], "fs");
  EXPECT_EQ(key[0]["allowed"], "more than 0");
}

// systems/KEYS.md is what the keys say of themselves today: build/taut help --page > systems/KEYS.md
TEST(Manners, ThePageOfKeysIsCurrent) {
  const std::string page = said("help --page");
  EXPECT_TRUE(page == contents(fs::path(TAUT_SCENES) / "KEYS.md"))
      << "build/taut help --page > systems/KEYS.md";
  EXPECT_GT(lines(page), 60);
  std::istringstream names(said("help --names"));
  std::string all;
  for (std::string name; std::getline(names, name);) {
    EXPECT_THAT(page, ContainsRegex("- `" + name + "[ `]")) << name;
    all += " " + name;
  }
  EXPECT_GE(lines(said("help" + all)), 2 * lines(said("help --names")));
}

TEST(Manners, MethodsAndScenes) {
  EXPECT_THAT(said("methods rattle"), AllOf(HasSubstr("tolerance = 1e-10"), Not(HasSubstr("baumgarte"))));
  EXPECT_THAT(said("methods ratle", 2), EndsWith("did you mean \"rattle\"?\n"));
  EXPECT_EQ(json::parse(said("methods shake --json"))[0]["name"], "shake");
  EXPECT_THAT(said("scenes"), AllOf(HasSubstr("pendulum"), HasSubstr("knee"), HasSubstr("flat_ring")));
  EXPECT_THAT(said("scenes --names"), AllOf(HasSubstr("\nwater\n"), HasSubstr("\nheme\n")));
  bool hard = false;
  for (const json& scene : json::parse(said("scenes --json")))
    hard |= scene["name"] == "heme" && scene["among"] != "";
  EXPECT_TRUE(hard);
  said("run flat_ring --steps 1");
  for (const char* list : {"methods", "scenes", "help run", "help method", "info water"}) {
    std::istringstream text(taut(list, "COLUMNS=80").text);
    for (std::string line; std::getline(text, line);)
      EXPECT_LE(std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xC0) != 0x80; }), 80)
          << line;
  }
}

TEST(Manners, WhatWasMeant) {
  EXPECT_EQ(said("rnu water", 2), "taut: there is no command \"rnu\"; did you mean \"run\"?\n");
  EXPECT_EQ(said("run water --stpes 3", 2), "taut: run: there is no option --stpes; did you mean --steps?\n");
  EXPECT_THAT(said("resume nowhere --steps 0", 2), HasSubstr("expected more than 0, got 0"));
  EXPECT_THAT(said("--threads 0 scenes", 2), HasSubstr("expected 1 to 1024 threads, got 0"));
  EXPECT_EQ(said("--threads all scenes", 2), "taut: --threads all: expected a whole number, or auto\n");
  EXPECT_THAT(said("--threads auto scenes"), HasSubstr("water"));
  EXPECT_EQ(said("run pair --steps two", 2),
            "taut: run: expected a number: --steps = two (taut run --help)\n");
  for (const char* command : {"run", "info", "calibrate", "chart", "stability", "crosscheck"})
    EXPECT_EQ(said(std::string(command) + " pair --dt-fs -1", 2),
              "taut: --dt-fs -1: expected more than 0, got -1\n");
  EXPECT_EQ(lines(said("", 2)), 1);
}

// All settings in force, each with who said it; what another setting leaves idle is not among them.
TEST(Manners, InfoSaysWhoSaidIt) {
  const std::string text = said("info water --dt-fs 1 --method shake --set run.seed=3");
  EXPECT_THAT(text, HasSubstr("648 atoms; 648 rigid bonds"));
  EXPECT_THAT(text, HasSubstr("216 molecules of 3 atoms"));
  EXPECT_THAT(text, HasSubstr("Lennard-Jones and Coulomb"));
  EXPECT_THAT(text, ContainsRegex("run\\.dt_fs +1 fs +--dt-fs 1\n"));
  EXPECT_THAT(text, ContainsRegex("run\\.seed +3 +--set run\\.seed=3\n"));
  EXPECT_THAT(text, ContainsRegex("method\\.name +\"shake\" +--method shake\n"));
  EXPECT_THAT(text, ContainsRegex("build\\.molecules +216 +water\\.toml:[0-9]+\n"));
  EXPECT_THAT(text, ContainsRegex("run\\.log_every +100 steps +default\n"));
  EXPECT_THAT(text, Not(HasSubstr("friction_per_ps")));
  const json info = json::parse(said("info decane --json"));
  EXPECT_EQ(info["scene"], "decane");
  EXPECT_GT(info["keys"].size(), 20u);
  EXPECT_THAT(said("info", 2), HasSubstr("expected a scene"));
}

// Places and molecules key by key, where their sections stand, by the names that --set takes.
TEST(Manners, InfoListsWhatAUserSaid) {
  const TemporaryFolder folder;
  const std::string scene = folder
                                .write("rods.toml",
                                       "[atom.B]\nmass_u = 72\n"
                                       "[molecule.rod]\natoms = [\"B\", \"B\"]\nbonds = [[0, 1, 0.35]]\n"
                                       "[[place]]\nmolecule = \"rod\"\ncount = 3\n"
                                       "[[place]]\nmolecule = \"rod\"\ncount = 4\n"
                                       "[build]\nbox_nm = [3, 0, 0, 1, 3, 0, -1, 1, 3]\n")
                                .string();
  const std::string text = said("info " + scene + " --set place.1.count=5");
  EXPECT_THAT(text, ContainsRegex("\n  place\\.0\\.molecule +\"rod\" +rods\\.toml:7\n"));
  EXPECT_THAT(text, ContainsRegex("\n  place\\.1\\.count +5 +--set place\\.1\\.count=5\n"));
  EXPECT_THAT(text, ContainsRegex("\n  molecule\\.rod\\.atoms +\\[\"B\", \"B\"\\] +rods\\.toml:4\n"));
  EXPECT_LT(text.find("atom.B.mass_u"), text.find("molecule.rod.bonds"));
  EXPECT_LT(text.find("molecule.rod.file"), text.find("place.0.molecule"));
  EXPECT_LT(text.find("place.1.count"), text.find("build.box_nm"));
  const json info = json::parse(said("info " + scene + " --json"));
  EXPECT_EQ(info["box_nm"], (std::vector<double>{3, 0, 0, 1, 3, 0, -1, 1, 3}));
  const auto& keys = info["keys"];
  const auto place =
      std::ranges::find_if(keys, [](const json& key) { return key["key"] == "place.0.molecule"; });
  ASSERT_NE(place, keys.end());
  EXPECT_EQ((*place)["allowed"], "one of opc, rod, spce, tip3p, tip4p2005, tip4pew, tip5p");
  EXPECT_EQ(json::parse(said("info water --json"))["box_nm"].size(), 3u);
  EXPECT_THAT(said("help molecule"), HasSubstr("molecule.NAME.at_most"));
  EXPECT_THAT(said("help start.box_nm"), HasSubstr("its vectors in reduced form"));
}

// No line of help is wider than the terminal.
TEST(Manners, HelpFitsTheTerminal) {
  for (const char* command :
       {"", "run", "calibrate", "chart", "stability", "crosscheck", "measure", "info", "resume"}) {
    std::istringstream help(taut(std::string(command) + " --help", "COLUMNS=80").text);
    for (std::string line; std::getline(help, line);) EXPECT_LE(line.size(), 83u) << command << ": " << line;
  }
}

TEST(Manners, RunsAreQuietWhereAsked) {
  EXPECT_EQ(said("run pair --steps 5 --quiet"), "");
  const json summary = json::parse(said("run pair --steps 5 --json"));
  EXPECT_EQ(summary["steps"], 5);
  const std::string text = said("run pair --steps 1");
  EXPECT_THAT(text, HasSubstr("  1 step of "));
  EXPECT_THAT(text, ContainsRegex("\n  1 thread of [0-9]+ core"));
  EXPECT_THAT(text, HasSubstr("[kJ/mol]"));
  EXPECT_THAT(said("run pair --steps 1 --threads 2"), HasSubstr("2 threads of "));
  EXPECT_THAT(said("run water --steps 0 --precision mixed"), HasSubstr("mixed precision (change with"));
  const std::string none = said("run pair --steps 0");
  EXPECT_THAT(none, HasSubstr("no step was taken"));
  EXPECT_THAT(none, AllOf(Not(HasSubstr("ns/day")), Not(HasSubstr("drift"))));
  std::istringstream table(said("run water --steps 10 --set run.log_every=5"));
  for (std::string line; std::getline(table, line) && !line.starts_with("mean");)
    EXPECT_TRUE(line.find_first_not_of(" 0123456789.-+e") != line.npos || line.size() <= 80) << line;
}

// A run that goes on keeps to --threads, as to OMP_NUM_THREADS.
TEST(Manners, ResumedRunsKeepToThreads) {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "run").string();
  said("run pair --steps 5 --out " + out);
  EXPECT_THAT(said("resume " + out + " --steps 5 --threads 2"), HasSubstr("2 threads of "));
}

// Its end is told in rows where there is no terminal, to people alone.
TEST(Manners, RunsInAFileSayWhenTheyEnd) {
  const std::string run = "run diatomic --steps 5";
  EXPECT_THAT(taut(run, "TAUT_PROGRESS_S=0").text,
              HasSubstr("\n  2 of 5 steps after 0:00:00, 0:00:00 left\n"));
  EXPECT_THAT(taut(run, "TAUT_PROGRESS_S=60").text, Not(HasSubstr("left")));
  EXPECT_EQ(taut(run + " --quiet", "TAUT_PROGRESS_S=0").text, "");
  EXPECT_THAT(taut(run + " --json", "TAUT_PROGRESS_S=0").text, Not(HasSubstr("left")));
}

// As many as the process may use, where the system is large enough; one for small ones.
TEST(Manners, RunsTakeTheCoresThatTheyGainFrom) {
  const std::string large = "run water --set build.molecules=700 --steps 0";
  const std::string two = usable_cores() > 1 ? "2 threads of " : "1 thread of ";
  EXPECT_THAT(said(large), HasSubstr(two));
  EXPECT_THAT(said(large + " --threads 1"), HasSubstr("1 thread of "));
  EXPECT_THAT(taut(large, "OMP_NUM_THREADS=1").text, HasSubstr("1 thread of "));
  EXPECT_THAT(taut(large + " --threads auto", "OMP_NUM_THREADS=1").text, HasSubstr(two));
  EXPECT_THAT(taut("run water --steps 0 --threads auto", "OMP_NUM_THREADS=3").text,
              HasSubstr("1 thread of "));
}

TEST(Manners, RunsSayHowManyThreadsHaveWork) {
  if (!has_threads()) GTEST_SKIP() << "built without OpenMP";
  EXPECT_THAT(said("run pair --steps 0 --threads 16"), HasSubstr("16 threads of "));
  EXPECT_THAT(said("run pair --steps 0 --threads 16"), HasSubstr(", of which so few atoms keep 1 busy"));
  EXPECT_THAT(said("run water --set forcefield.coulomb=pme --steps 0 --threads 16"),
              HasSubstr(", of which so few atoms keep 3 busy"));
  EXPECT_THAT(said("run water --set build.molecules=700 --steps 0 --threads 2"), Not(HasSubstr("busy")));
  EXPECT_THAT(said("run water --set build.molecules=1000 --steps 0"), Not(HasSubstr("busy"))) << "by default";
}

// A ladder of 2000 squares is one cluster; the triangles of as many waters are one each.
TEST(Manners, ManyRingsOfOneClusterAreToldBeforeTheStart) {
  std::string atoms, bonds;
  for (int k = 0; k <= 2000; ++k) {
    atoms += fmt::format("[{}, 0, 0, 1], [{}, 1, 0, 1], ", k, k);
    bonds += fmt::format("[{}, {}, 1], ", 2 * k, 2 * k + 1);
    if (k > 0) bonds += fmt::format("[{}, {}, 1], [{}, {}, 1], ", 2 * k - 2, 2 * k, 2 * k - 1, 2 * k + 1);
  }
  const TemporaryFolder folder;
  const std::string scene =
      folder
          .write("ladder.toml",
                 fmt::format("[build]\nkind = \"atoms\"\natoms = [{}]\nbonds = [{}]\n", atoms, bonds))
          .string();
  EXPECT_THAT(said("run " + scene + " --steps 0"), HasSubstr("one cluster of rigid bonds closes 2000 rings"));
  EXPECT_THAT(said("run water --set build.molecules=2100 --steps 0"), Not(HasSubstr("rings")));
}

// How many threads compute unless a run says so itself: the first number of OMP_NUM_THREADS, and what is none
// is refused.
TEST(Manners, OmpNumThreadsIsRead) {
  const auto run = [](const std::string& value) {
    return taut("run pair --steps 0", "OMP_NUM_THREADS=" + value + " OMP_DYNAMIC=true OMP_THREAD_LIMIT=2");
  };
  for (const auto& [value, threads] : std::map<std::string, std::string>{
           {"3", "3"}, {"4,2", "4"}, {"' 2 , 1'", "2"}, {"''", "1"}, {"' '", "1"}, {"1024", "1024"}}) {
    const Outcome outcome = run(value);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    EXPECT_THAT(outcome.text, HasSubstr("  " + threads + (threads == "1" ? " thread of " : " threads of ")))
        << value;
  }
  for (const char* value : {"0", "-1", "two", "2x", "1e3", "1025", "99999999999999999999", ",2"}) {
    const Outcome outcome = run(value);
    EXPECT_EQ(outcome.exit_code, 2) << value;
    EXPECT_THAT(
        outcome.text,
        EndsWith(fmt::format("taut: OMP_NUM_THREADS={}: expected a whole number from 1 to 1024\n", value)));
  }
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "study").string();
  EXPECT_EQ(taut("chart pair --quick --out " + out, "OMP_NUM_THREADS=two").exit_code, 2);
  EXPECT_FALSE(fs::exists(out));
  EXPECT_EQ(taut("run pair --steps 0 --threads 2", "OMP_NUM_THREADS=two").exit_code, 0);
}

// As a shell asks: words so far, the last of them to be completed.
std::string completed(const std::string& words, int last) {
  const TemporaryFolder folder;
  const auto file = folder.write("taut.bash", said("generate bash"));
  const std::string script = fmt::format(
      "taut() {{ {} \"$@\"; }}; compopt() {{ :; }}; source {}; COMP_WORDS=({}); COMP_CWORD={}; _taut_words; "
      "echo \"${{COMPREPLY[*]}}\"",
      TAUT_BINARY, file.string(), words, last);
  return taut("-c '" + script + "'", "", "bash").text;
}

TEST(Manners, Completions) {
  EXPECT_EQ(completed("taut cal", 1), "calibrate\n");
  EXPECT_EQ(completed("taut run wate", 2), "water water_cluster\n");
  EXPECT_EQ(completed("taut run --dt", 2), "--dt-fs\n");
  EXPECT_EQ(completed("taut run water --method ratt", 4), "rattle\n");
  EXPECT_EQ(completed("taut run water --set run.dt", 4), "run.dt_fs=\n");
  EXPECT_EQ(completed("taut run water --set run.dt_fs=1 --ou", 5), "--out\n");
  EXPECT_EQ(completed("taut help run.tempera", 2), "run.temperature_k\n");
  const std::string zsh = said("generate zsh");
  EXPECT_THAT(zsh, AllOf(::testing::StartsWith("#compdef taut\n"), HasSubstr("_taut_words() {"),
                         HasSubstr("_bash_complete $space -F _taut_words\n")));
  said("generate fish", 2);
}

TEST(Manners, ManPage) {
  const std::string page = said("generate man");
  for (const char* part :
       {".TH TAUT 1", ".SS taut run", "\\-\\-dt\\-fs", ".SS taut measure", ".SH EXIT STATUS"})
    EXPECT_THAT(page, HasSubstr(part));
}

// Two runs' worth of chains, whose law is known: ⟨R²⟩ = 19 b², without forces D = what velocities make of it.
TEST(Manners, Measures) {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "run").string(), at = (folder.path() / "measured").string();
  EXPECT_THAT(said("measure " + out, 2), HasSubstr("run"));
  const json summary =
      json::parse(said("run freely_jointed --steps 400 --set run.log_every=10 run.trajectory_every=10 "
                       "--measure --json --out " +
                       out));
  const json measured = json::parse(said("measure " + out + " --json --out " + at));
  EXPECT_EQ(measured["frames"], 41);
  EXPECT_EQ(summary["measured"]["frames"], 41);
  EXPECT_NEAR(summary["measured"]["end_to_end_squared_nm2"]["value"],
              measured["end_to_end_squared_nm2"]["value"], 1e-5);
  EXPECT_NEAR(measured["interval_ps"], 0.1, 1e-6);
  EXPECT_NEAR(measured["end_to_end_squared_nm2"]["value"], 19, 5);
  EXPECT_TRUE(fs::exists(fs::path(at) / "displacement.csv"));
  EXPECT_NEAR(measured["displacement_exponent"].get<double>(), 2, 0.01) << "no force, no bath: straight on";
  EXPECT_THAT(said("measure " + out),
              AllOf(HasSubstr("no D yet"), HasSubstr("⟨R²⟩"), HasSubstr("41 frames of 2000 atoms")));
  EXPECT_THAT(said("measure " + out + " --atoms BEAD BEED", 2), HasSubstr("did you mean \"BEAD\"?"));
  said("run pair --steps 5 --out " + at + "2");
  EXPECT_THAT(said("measure " + at + "2"),
              AllOf(HasSubstr("2 rows of the log"), HasSubstr("run.trajectory_every=100")));
  EXPECT_THAT(said("measure " + at + "2 --atoms A A", 2), HasSubstr("run.trajectory_every=100"));
}

}  // namespace
}  // namespace taut::manners_tests
