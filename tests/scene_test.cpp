// Scene files: what is read, what overrides do, and what every bad input is told.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "constraints/baumgarte.hpp"
#include "constraints/rattle.hpp"
#include "md/errors.hpp"
#include "systems/scene_file.hpp"
#include "temporary_folder.hpp"

namespace taut {
namespace {

using testing::HasSubstr;
using testing::Not;

// A scene in a file, changed by replacing one text with another.
struct SceneText {
  std::string text = R"(hard_on = "a test"
[build]
kind = "atoms"
atoms = [
  [0, 0, 0, 0],
  [1, 0, 0, 1],
  [2, 0, 0, 1.5],
]
bonds = [
  [0, 1, 1],
  [1, 2, 1],
]
gravity_nm_ps2 = [0, -9.81, 0]
pulls = [[2, 1, 2, 3]]
[run]
dt_fs = 0.5
steps = 20
[method]
name = "baumgarte"
alpha_per_ps = 3.0
passes = 2
)";

  SceneText with(const std::string& old, const std::string& changed) const {
    const auto at = text.find(old);
    EXPECT_NE(at, std::string::npos) << old;
    return {std::string(text).replace(at, old.size(), changed)};
  }
};

const std::string kMelt = R"(hard_on = "a test"
[build]
kind = "melt"
chains = 10
beads = 20
bond_nm = 0.97
mass_u = 1.0
density_per_nm3 = 0.85
bonds = "rigid"
[forcefield]
pair = "lennard-jones"
sigma_nm = 1.0
epsilon_kj_mol = 1.0
cutoff_nm = 2.5
)";

// What reading says, with the file's folder taken out; the folder is left as it was.
std::string complaint(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const TemporaryFolder folder;
  const auto file = folder.write("scene.toml", text);
  std::string message = "no error";
  try {
    read_scene(file, overrides);
  } catch (const InputError& e) {
    message = e.what();
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  EXPECT_THAT(message, Not(HasSubstr("\n")));
  const std::string prefix = folder.path().string() + "/";
  if (const auto at = message.find(prefix); at != std::string::npos) message.erase(at, prefix.size());
  return message;
}

Scene read(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const TemporaryFolder folder;
  return read_scene(folder.write("scene.toml", text), overrides);
}

TEST(Scene, ReadsWhatTheFileSays) {
  const Scene scene = read(SceneText{}.text);
  EXPECT_EQ(scene.name, "scene");
  EXPECT_EQ(scene.hard_on, "a test");
  EXPECT_EQ(scene.system.mass, Eigen::Vector3d(0, 1, 1.5));
  ASSERT_EQ(scene.system.bond_count(), 2);
  EXPECT_EQ(scene.system.bonds[1].i, 1);
  EXPECT_EQ(scene.system.bonds[1].j, 2);
  EXPECT_EQ(scene.start.x.col(2), Vec3(2, 0, 0));
  EXPECT_EQ(scene.start.v, Vectors::Zero(3, 3));
  EXPECT_EQ(scene.terms.gravity.value(), Vec3(0, -9.81, 0));
  ASSERT_EQ(scene.terms.pulls.size(), 1u);
  EXPECT_EQ(scene.terms.pulls[0].force, Vec3(1, 2, 3));
  EXPECT_EQ(scene.run.dt_fs, 0.5);
  EXPECT_EQ(scene.run.steps, 20);
  const auto& options = *scene.method.get_if<Baumgarte::Options>();
  EXPECT_EQ(options.alpha_per_ps, 3.0);
  EXPECT_EQ(options.beta_per_ps, std::nullopt);
  EXPECT_EQ(options.passes, 2);
}

TEST(Scene, OverridesPrevail) {
  const Scene scene =
      read(SceneText{}.text, {"run.dt_fs=2", "run.steps = 1e6", "method.gains=critical", "run.dt_fs=4"});
  EXPECT_EQ(scene.run.dt_fs, 4);
  EXPECT_EQ(scene.run.steps, 1000000);
  const auto& options = *scene.method.get_if<Baumgarte::Options>();
  EXPECT_EQ(options.gains, "critical");
  EXPECT_EQ(options.passes, 2);  // the file's own method: its other keys stay
}

TEST(Scene, AnotherMethodSetsTheFilesKeysAside) {
  const Scene scene = read(SceneText{}.text, {"method.tolerance=1e-6", "method.name=rattle"});
  const auto& options = *scene.method.get_if<Rattle::Options>();
  EXPECT_EQ(options.tolerance, 1e-6);
  EXPECT_EQ(options.max_sweeps, Rattle::Options{}.max_sweeps);
}

TEST(Scene, NamingTheFilesOwnMethodKeepsItsKeys) {
  const Scene scene = read(SceneText{}.text, {"method.name=\"baumgarte\""});
  EXPECT_EQ(scene.method.get_if<Baumgarte::Options>()->passes, 2);
}

TEST(Scene, OverridesOfASceneFromElsewhere) {
  Scene scene = read(SceneText{}.text);
  apply_overrides(scene, {"run.log_every=7", "method.passes=3"});
  EXPECT_EQ(scene.run.log_every, 7);
  EXPECT_EQ(scene.run.dt_fs, 0.5);
  EXPECT_EQ(scene.method.get_if<Baumgarte::Options>()->passes, 3);
  EXPECT_EQ(scene.method.get_if<Baumgarte::Options>()->alpha_per_ps, 3.0);
  EXPECT_THROW(apply_overrides(scene, {"build.molecules=7"}), InputError);
}

// What nothing reads, as the other keys are, is refused with what it takes; an override that makes a key of
// the file idle sets it aside.
TEST(SceneErrors, KeysWithoutEffect) {
  const SceneText good;
  const auto in_run = [&](const std::string& keys) { return complaint(good.with("steps = 20", keys).text); };
  EXPECT_EQ(in_run("friction_per_ps = 1"),
            "scene.toml:17: run.friction_per_ps: has no effect, it counts only with run.thermostat = "
            "\"langevin\"");
  EXPECT_THAT(in_run("temperature_k = 300\nthermostat = \"langevin\"\nthermostat_ps = 1"),
              HasSubstr("scene.toml:19: run.thermostat_ps: has no effect"));
  EXPECT_THAT(in_run("temperature_k = 300\nthermostat = \"none\"\nthermostat_ps = 1"),
              HasSubstr("scene.toml:19: run.thermostat_ps: has no effect"));
  EXPECT_THAT(in_run("minimise_force_kj_mol_nm = 10"), HasSubstr("with run.minimise = true"));
  EXPECT_THAT(in_run("trajectory = \"h5md\""), HasSubstr("with run.trajectory_every above 0"));
  EXPECT_EQ(in_run("temperature_k = 300\nthermostat = \"langevin\"\nfriction_per_ps = 1"), "no error");
  EXPECT_EQ(in_run("trajectory_every = 5\ntrajectory = \"h5md\""), "no error");

  const std::string langevin =
      good.with("steps = 20", "temperature_k = 300\nthermostat = \"langevin\"\nfriction_per_ps = 1").text;
  EXPECT_EQ(complaint(langevin, {"run.thermostat=none"}), "no error");
  EXPECT_THAT(complaint(langevin, {"run.thermostat_ps=1"}),
              HasSubstr("--set run.thermostat_ps=1: run.thermostat_ps: has no effect"));
  EXPECT_THAT(complaint(langevin, {"run.thermostat=none", "run.friction_per_ps=2"}),
              HasSubstr("--set run.friction_per_ps=2: run.friction_per_ps: has no effect"));
}

TEST(SceneErrors, MethodKeysWithoutEffect) {
  const std::string good = SceneText{}.text;
  const auto idle = [&](std::vector<std::string> overrides) {
    const std::string said = complaint(good, overrides);
    const auto at = said.find("has no effect, it counts only ");
    return at == said.npos ? said : said.substr(at + 30);
  };
  EXPECT_EQ(idle({"method.reduction=0.1"}), "with method.gains = \"rattle\"");
  EXPECT_EQ(idle({"method.gains=rattle", "method.reduction=0.1"}), "no error");
  EXPECT_EQ(idle({"method.stiffness=1e5"}), "with method.gains = \"physical\"");
  EXPECT_EQ(idle({"method.gains=physical", "method.stiffness=1e5"}), "no error");
  EXPECT_EQ(idle({"method.gains=physical", "method.stiffness=1e5", "method.beta_per_ps=1"}),
            "without both alpha_per_ps and beta_per_ps");
  EXPECT_EQ(idle({"method.gains=numbers", "method.beta_per_ps=1"}), "no error");
  for (const std::string name : {"shake", "rattle"}) {
    EXPECT_EQ(idle({"method.name=" + name, "method.sweeps=3", "method.tolerance=1e-6"}),
              "without method.sweeps");
    EXPECT_EQ(idle({"method.name=" + name, "method.sweeps=3", "method.max_sweeps=6"}),
              "without method.sweeps");
    EXPECT_EQ(idle({"method.name=" + name, "method.max_sweeps=6", "method.tolerance=1e-6"}), "no error");
  }
  EXPECT_EQ(idle({"method.name=penalty", "method.k=1e4", "method.omega_h=0.1"}), "without method.k");
}

// A chain of the file's own: three atoms, of which two move.
std::string moving(const std::string& velocities, const std::string& run) {
  return SceneText{}.with("pulls", velocities + "pulls").with("steps = 20", run).text;
}
const std::string kMoving = "velocities = [[0, 0, 0], [0, 1, 0], [0, 2, 0]]\n";

TEST(Velocities, AreKeptWhereTheStartHasSomeAndDrawnWhereAsked) {
  const Scene kept = read(moving(kMoving, "steps = 20"));
  EXPECT_EQ(kept.start.v.col(2), Vec3(0, 2, 0));
  EXPECT_FALSE(kept.velocities_drawn);
  const Scene bath = read(moving(kMoving, "temperature_k = 300\nthermostat = \"langevin\""));
  EXPECT_EQ(bath.start.v.col(2), Vec3(0, 2, 0));
  const Scene drawn = read(moving(kMoving, "temperature_k = 300\nvelocities = \"draw\""));
  EXPECT_TRUE(drawn.velocities_drawn);
  EXPECT_NE(drawn.start.v.col(2), Vec3(0, 2, 0));
  EXPECT_EQ(drawn.start.v.col(0), Vec3::Zero());  // an anchor
  const Scene at_rest = read(moving("", "temperature_k = 300"));
  EXPECT_EQ(at_rest.start.v, drawn.start.v);
  const Scene stays = read(moving("", "temperature_k = 300\nthermostat_ps = 1\nvelocities = \"keep\""));
  EXPECT_EQ(stays.start.v, Vectors::Zero(3, 3));
  EXPECT_EQ(read(moving("", "steps = 20")).start.v, Vectors::Zero(3, 3));
}

TEST(Velocities, ATemperatureThatDoesNothingIsRefused) {
  EXPECT_THAT(
      complaint(moving(kMoving, "temperature_k = 300")),
      HasSubstr("scene.toml:18: run.temperature_k: has no effect, it counts only with a thermostat or "
                "run.velocities = \"draw\""));
  EXPECT_THAT(complaint(moving(kMoving, "steps = 20"), {"run.temperature_k=300"}),
              HasSubstr("--set run.temperature_k=300: run.temperature_k: has no effect"));
  EXPECT_THAT(complaint(moving(kMoving, "steps = 20"), {"run.seed=3"}), HasSubstr("run.seed: has no effect"));
  EXPECT_THAT(complaint(moving(kMoving, "velocities = \"draw\"")),
              HasSubstr("scene.toml:18: run.velocities: drawn at run.temperature_k, which is 0"));
  const std::string draws = moving(kMoving, "temperature_k = 300\nvelocities = \"draw\"");
  EXPECT_EQ(complaint(draws, {"run.seed=3"}), "no error");
  EXPECT_EQ(complaint(draws, {"run.velocities=keep"}), "no error");  // sets the file's temperature aside
  EXPECT_THAT(complaint(draws, {"run.velocities=keep", "run.temperature_k=200"}),
              HasSubstr("run.temperature_k: has no effect"));
}

// As a State of OpenMM's comes: with velocities, or without.
TEST(Velocities, OfASceneFromElsewhere) {
  Scene moves = read(moving(kMoving, "steps = 20")), rests = read(moving("", "steps = 20"));
  EXPECT_THROW(apply_overrides(moves, {"run.temperature_k=300"}), InputError);
  moves = read(moving(kMoving, "steps = 20"));
  apply_overrides(moves, {"run.temperature_k=300", "run.thermostat=langevin"});
  EXPECT_EQ(moves.start.v.col(2), Vec3(0, 2, 0));
  apply_overrides(rests, {"run.temperature_k=300", "run.thermostat=langevin"});
  EXPECT_TRUE(rests.velocities_drawn);
  apply_overrides(moves, {"run.velocities=draw"});
  EXPECT_EQ(moves.start.v, rests.start.v);
  apply_overrides(moves, {"run.seed=2"});
  EXPECT_NE(moves.start.v, rests.start.v);
  apply_overrides(rests, {"run.seed=2"});
  EXPECT_EQ(moves.start.v, rests.start.v);
}

TEST(SceneErrors, Keys) {
  const SceneText good;
  EXPECT_EQ(complaint(good.with("dt_fs", "dt_sf").text),
            "scene.toml:16: unknown key \"dt_sf\" in [run]; did you mean \"dt_fs\"?");
  EXPECT_EQ(complaint(good.with("steps = 20", "temprature_k = 300").text),
            "scene.toml:17: unknown key \"temprature_k\" in [run]; did you mean \"temperature_k\"?");
  EXPECT_EQ(complaint(good.with("passes", "pases").text),
            "scene.toml:21: unknown key \"pases\" in [method]; did you mean \"passes\"?");
  EXPECT_EQ(complaint(good.with("passes", "tolerance").text),
            "scene.toml:21: unknown key \"tolerance\" in [method]; expected one of alpha_per_ps, "
            "beta_per_ps, damping, "
            "gains, name, passes, reduction, stiffness, sweeps");
  EXPECT_EQ(complaint(good.with("[run]", "[rum]").text),
            "scene.toml:15: unknown section \"rum\"; did you mean \"run\"?");
  EXPECT_EQ(complaint(good.with("gravity_nm_ps2", "gravity").text),
            "scene.toml:13: unknown key \"gravity\" in [build]; did you mean \"gravity_nm_ps2\"?");
  EXPECT_EQ(complaint(good.with("[run]", "[forcefield]\ncutoff_nm = 1\n[run]").text),
            "scene.toml:16: unknown key \"cutoff_nm\" in [forcefield]");
  EXPECT_EQ(complaint(good.with("hard_on = \"a test\"", "").text), "scene.toml: missing key \"hard_on\"");
  EXPECT_EQ(complaint(good.with("kind = \"atoms\"", "").text),
            "scene.toml:2: missing key \"kind\" in [build]");
  EXPECT_EQ(complaint("hard_on = 'x'"), "scene.toml: missing key \"kind\" in [build]");
}

TEST(SceneErrors, Values) {
  const SceneText good;
  EXPECT_EQ(complaint(good.with("0.5", "\"fast\"").text),
            "scene.toml:16: run.dt_fs: expected a number, got a string");
  EXPECT_EQ(complaint(good.with("20", "2.5").text),
            "scene.toml:17: run.steps: expected an integer, got a number");
  EXPECT_EQ(complaint(good.with("0.5", "0").text), "scene.toml:16: run.dt_fs: expected more than 0, got 0");
  EXPECT_EQ(complaint(good.with("0.5", "nan").text),
            "scene.toml:16: run.dt_fs: expected a finite number, got nan");
  EXPECT_EQ(complaint(good.with("steps = 20", "steps = -1").text),
            "scene.toml:17: run.steps: expected at least 0, got -1");
  EXPECT_EQ(complaint(good.with("passes = 2", "passes = 1e10").text),
            "scene.toml:21: method.passes: out of range");
  EXPECT_EQ(complaint(good.with("steps = 20", "steps = 1e30").text),
            "scene.toml:17: run.steps: out of range");
  EXPECT_EQ(complaint(good.with("steps = 20", "thermostat_ps = 0.1").text),
            "scene.toml:17: run.thermostat_ps: a thermostat needs a run.temperature_k above 0");
  EXPECT_EQ(complaint(good.with("steps = 20", "thermostat = \"langevin\"").text),
            "scene.toml:17: run.thermostat: a thermostat needs a run.temperature_k above 0");
  EXPECT_EQ(complaint(good.with("\"atoms\"", "\"atom\"").text),
            "scene.toml:3: build.kind: there is no \"atom\"; did you mean \"atoms\"?");
  EXPECT_THAT(
      complaint(good.with("\"baumgarte\"", "\"ratle\"").text),
      HasSubstr("scene.toml:19: method.name: there is no method \"ratle\"; did you mean \"rattle\"?"));
  EXPECT_EQ(complaint(good.with("[0, -9.81, 0]", "[0, -9.81]").text),
            "scene.toml:13: build.gravity_nm_ps2: expected three numbers [x, y, z], got an array");
  EXPECT_EQ(complaint("build = 3\nhard_on = ''"), "scene.toml:1: build: expected a section, got an integer");
}

TEST(SceneErrors, AtomsAndBonds) {
  const SceneText good;
  EXPECT_EQ(complaint(good.with("[1, 2, 1]", "[1, 0, 2]").text),
            "scene.toml:11: build.bonds[1]: bond 1 (1-0): repeats bond 0, two bonds on the same pair");
  EXPECT_EQ(complaint(good.with("[1, 2, 1]", "[1, 3, 1]").text),
            "scene.toml:11: build.bonds[1]: bond 1: atom 3 is out of range, the system has atoms 0 to 2");
  EXPECT_EQ(complaint(good.with("[0, 1, 1]", "[0, 1, 0]").text),
            "scene.toml:10: build.bonds[0]: bond 0 (0-1): length 0 nm, expected more than 0");
  EXPECT_EQ(complaint(good.with("[1, 0, 0, 1]", "[1, 0, 0, 0]").text),
            "scene.toml:10: build.bonds[0]: bond 0 (0-1): both ends are anchored (mass 0)");
  EXPECT_EQ(complaint(good.with("[1, 2, 1]", "[1, 1, 1]").text),
            "scene.toml:11: build.bonds[1]: bond 1: ties atom 1 to itself");
  EXPECT_EQ(complaint(good.with("[1, 2, 1]", "[1, 1.5, 1]").text),
            "scene.toml:11: build.bonds[1]: expected an atom's index, counted from 0");
  EXPECT_EQ(complaint(good.with("[1, 2, 1]", "[1, 2]").text),
            "scene.toml:11: build.bonds[1]: expected 3 numbers, got 2");
  EXPECT_EQ(complaint(good.with("[1, 2, 1]", "[1, 2, 1, 4]").text),
            "scene.toml:11: build.bonds[1]: expected 3 numbers, got 4");
  EXPECT_EQ(complaint(good.with("[1, 2, 1]", "[1, 2, inf]").text),
            "scene.toml:11: build.bonds[1]: expected finite numbers");
  EXPECT_EQ(complaint(good.with("[1, 2, 1]", "7").text),
            "scene.toml:11: build.bonds[1]: expected a row of numbers, got an integer");
  EXPECT_EQ(complaint(good.with("1.5]", "\"a\"]").text),
            "scene.toml:7: build.atoms[2]: expected numbers, got a string");
  EXPECT_EQ(complaint(good.with("1.5]", "-1]").text),
            "scene.toml:7: build.atoms[2]: expected a mass above 0, or 0 for an anchor");
  EXPECT_EQ(complaint(good.with("[2, 1, 2, 3]", "[3, 1, 2, 3]").text),
            "scene.toml:14: build.pulls[0]: there is no such atom");
  EXPECT_EQ(complaint(good.with("pulls", "velocities = [[0, 0, 0]]\npulls").text),
            "scene.toml:14: build.velocities: expected one for each atom");
}

TEST(SceneErrors, CountsAndLengths) {
  EXPECT_EQ(complaint(kMelt, {"run.steps=0"}), "no error");
  const auto with = [](const char* old, const char* changed) {
    return complaint(SceneText{kMelt}.with(old, changed).text);
  };
  EXPECT_EQ(with("chains = 10", "chains = -10"), "scene.toml:4: build.chains: expected at least 1, got -10");
  EXPECT_EQ(with("chains = 10", "chains = 1e12"),
            "scene.toml:4: build.chains: 1000000000000 make 20000000000000 atoms, more than the 5000000 taut "
            "takes");
  EXPECT_THAT(with("beads = 20", "beads = 9000000000000000000"),
              HasSubstr("scene.toml:4: build.chains: 10 make 9e+19"));
  EXPECT_EQ(with("bond_nm = 0.97", "bond_nm = 0"),
            "scene.toml:6: build.bond_nm: expected more than 0, got 0");
  EXPECT_EQ(with("cutoff_nm = 2.5", "cutoff_nm = 3.5"),
            "scene.toml:14: forcefield.cutoff_nm: 3.5 is over half the box, 2.855");
  EXPECT_EQ(with("cutoff_nm = 2.5", ""), "scene.toml:10: missing key \"cutoff_nm\" in [forcefield]");
  EXPECT_EQ(with("cutoff_nm = 2.5", "cutoff_nm = 2.5\nswitch_nm = 2.6"),
            "scene.toml:15: forcefield.switch_nm: expected less than forcefield.cutoff_nm");
  EXPECT_THAT(
      with("cutoff_nm = 2.5", "cutoff_nm = 2.5\nrf_dielectric = 5"),
      HasSubstr("scene.toml:15: forcefield.rf_dielectric: has no effect, it counts only between charges"));
  EXPECT_EQ(with("cutoff_nm = 2.5", "cutoff_nm = 2.5\nprecision = \"single\""),
            "scene.toml:15: forcefield.precision: there is no \"single\"; expected one of double, mixed");
  EXPECT_EQ(with("cutoff_nm = 2.5", "cutoff_nm = 2.5\nprecision = \"mixed\""), "no error");
  EXPECT_THAT(with("0.85", "0.05"), HasSubstr("scene.toml:8: build.density_per_nm3: 0.05 is too low"));
  EXPECT_THAT(with("0.85", "5"), HasSubstr("scene.toml:8: build.density_per_nm3: 5 is too high"));
}

TEST(SceneErrors, Overrides) {
  const std::string good = SceneText{}.text;
  EXPECT_EQ(complaint(good, {"run.dt_fs=abc"}),
            "--set run.dt_fs=abc: run.dt_fs: expected a number, got a string");
  EXPECT_EQ(complaint(good, {"run.dt=2"}),
            "--set run.dt=2: unknown key \"dt\" in [run]; did you mean \"dt_fs\"?");
  EXPECT_EQ(complaint(good, {"rum.dt_fs=2"}),
            "--set rum.dt_fs=2: unknown section \"rum\"; did you mean \"run\"?");
  EXPECT_EQ(complaint(good, {"build.molecules=2"}),
            "--set build.molecules=2: unknown key \"molecules\" in [build]; expected one of atoms, bonds, "
            "gravity_nm_ps2, kind, pulls, start, velocities");
  EXPECT_EQ(complaint(good, {"run.steps"}), "--set run.steps: expected key=value, such as run.dt_fs=2");
  EXPECT_EQ(complaint(good, {"=3"}), "--set =3: expected key=value, such as run.dt_fs=2");
  EXPECT_EQ(complaint(good, {"a b=3"}), "--set a b=3: expected key=value, such as run.dt_fs=2");
  EXPECT_EQ(complaint(good, {"run=3"}), "--set run=3: run: expected a section, got an integer");
  EXPECT_EQ(complaint(good, {"method.name=newton", "method.passes=1"}),
            "--set method.passes=1: unknown key \"passes\" in [method]; expected one of max_iterations, "
            "name, tolerance");
  EXPECT_THAT(
      complaint(good, {"method.name=newtom"}),
      HasSubstr("--set method.name=newtom: method.name: there is no method \"newtom\"; did you mean"));
  EXPECT_EQ(
      complaint(kMelt, {"build.chains=1e12"}),
      "--set build.chains=1e12: build.chains: 1000000000000 make 20000000000000 atoms, more than the 5000000 "
      "taut takes");
}

TEST(SceneErrors, Files) {
  EXPECT_EQ(complaint("hard_on = \"a test\"\n[build\n").substr(0, 35), "scene.toml:2: not valid TOML: Error");
  EXPECT_THAT(complaint("\x01\x02 this is no TOML"), HasSubstr("scene.toml:1: not valid TOML"));
  EXPECT_THAT(complaint("<?xml version=\"1.0\"?>"), HasSubstr("scene.toml:1: not valid TOML"));
  EXPECT_THAT(complaint(""), HasSubstr("missing key \"hard_on\""));
  EXPECT_THAT(complaint(SceneText{}.with("[run]", "start = \"nowhere.start.toml\"\n[run]").text),
              HasSubstr("nowhere.start.toml: no such file"));
  try {
    read_scene("/nowhere/at/all.toml");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "/nowhere/at/all.toml: no such file");
  }
}

// What only the system or the force field can find carries the file's name too.
TEST(SceneErrors, OfTheForceFieldNameTheFile) {
  const std::string small =
      SceneText{kMelt}.with("chains = 10", "chains = 1").with("beads = 20", "beads = 3").text;
  EXPECT_THAT(complaint(small, {"forcefield.pair=wca"}), HasSubstr("unknown key \"cutoff_nm\""));
  EXPECT_THAT(complaint(SceneText{small}.with("cutoff_nm = 2.5", "").text, {"forcefield.pair=wca"}),
              testing::StartsWith("scene.toml: "));
}

TEST(SceneList, FindsScenesByNameAndPath) {
  const auto water = find_scene("water");
  EXPECT_EQ(water, scenes_folder() / "water.toml");
  EXPECT_EQ(find_scene(water.string()), water);
  try {
    find_scene("watre");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "watre: no such file, and no scene of that name; did you mean \"water\"?");
  }
}

TEST(SceneList, ListsEverySceneAndNoStart) {
  const TemporaryFolder folder;
  folder.write("b.toml", "hard_on = 'second'");
  folder.write("a.toml", "hard_on = 'first'");
  folder.write("a.start.toml", "atoms = []");
  folder.write("notes.txt", "");
  const auto scenes = list_scenes(folder.path());
  ASSERT_EQ(scenes.size(), 2u);
  EXPECT_EQ(scenes[0].name, "a");
  EXPECT_EQ(scenes[0].hard_on, "first");
  EXPECT_EQ(scenes[1].name, "b");
}

}  // namespace
}  // namespace taut
