// What every bad input of a scene is told: one line with the file, the line and the key.

#include "constraints/methods/baumgarte.hpp"
#include "polymer_scene.hpp"

namespace taut::scene_errors_tests {
namespace {

using testing::HasSubstr;
using testing::Not;

const SceneText kGood;

std::string said(const std::string& old, const std::string& changed) {
  return complaint(kGood.with(old, changed).text);
}

// What nothing reads, as the other keys are, is refused with what it takes; an override that makes a key of
// the file idle sets it aside.
TEST(SceneErrors, KeysWithoutEffect) {
  const auto in_run = [&](const std::string& keys) { return said("steps = 20", keys); };
  EXPECT_THAT(in_run("friction_per_ps = 1"), HasSubstr("scene.toml:17: run.friction_per_ps: has no effect"));
  EXPECT_THAT(in_run("temperature_k = 300\nthermostat = \"langevin\"\nthermostat_ps = 1"),
              HasSubstr("scene.toml:19: run.thermostat_ps: has no effect"));
  EXPECT_THAT(in_run("temperature_k = 300\nthermostat = \"none\"\nthermostat_ps = 1"),
              HasSubstr("scene.toml:19: run.thermostat_ps: has no effect"));
  EXPECT_THAT(in_run("minimise_force_kj_mol_nm = 10"), HasSubstr("with run.minimise = true"));
  EXPECT_THAT(in_run("trajectory = \"h5md\""), HasSubstr("with run.trajectory_every above 0"));
  EXPECT_EQ(in_run("temperature_k = 300\nthermostat = \"langevin\"\nfriction_per_ps = 1"), "no error");
  EXPECT_EQ(in_run("trajectory_every = 5\ntrajectory = \"dcd\""), "no error");

  const std::string langevin =
      kGood.with("steps = 20", "temperature_k = 300\nthermostat = \"langevin\"\nfriction_per_ps = 1").text;
  EXPECT_EQ(complaint(langevin, {"run.thermostat=none"}), "no error");
  EXPECT_THAT(complaint(langevin, {"run.thermostat_ps=1"}), HasSubstr("thermostat_ps: has no effect"));
  EXPECT_THAT(complaint(langevin, {"run.thermostat=none", "run.friction_per_ps=2"}),
              HasSubstr("--set run.friction_per_ps=2: run.friction_per_ps: has no effect"));
}

TEST(SceneErrors, BarostatsWithoutWhatTheyNeed) {
  const std::string water = R"(hard_on = "pressed"
build = {kind = "water", model = "tip3p", shape = "box", molecules = 216, density_g_cm3 = 0.99}
forcefield = {cutoff_nm = 0.9, rf_dielectric = 78.3}
[run]
temperature_k = 300
)";
  EXPECT_EQ(complaint(water, {"run.barostat=c-rescale"}),
            "--set run.barostat=c-rescale: run.barostat: a barostat needs a thermostat: run.thermostat = "
            "\"langevin\" or \"rescaling\"");
  const std::vector<std::string> warm = {"run.thermostat=langevin", "run.barostat=c-rescale"};
  EXPECT_EQ(complaint(water, warm), "no error");
  const auto with = [&](const char* key) {
    std::vector<std::string> keys = warm;
    keys.emplace_back(key);
    return complaint(water, keys);
  };
  EXPECT_EQ(with("run.coupling=anisotropic"), "no error");
  EXPECT_THAT(with("run.coupling=triclinic"), HasSubstr("there is no \"triclinic\""));
  EXPECT_THAT(with("run.compressibility_per_bar=0"), HasSubstr("expected more than 0"));
  EXPECT_THAT(with("run.barostat_every=0"), HasSubstr("expected at least 1"));
  EXPECT_THAT(complaint(water, {"run.pressure_bar=1"}), HasSubstr("counts only with run.barostat"));
  EXPECT_THAT(complaint(water, {"run.thermostat=langevin", "run.barostat=monte-carlo", "run.barostat_ps=1"}),
              HasSubstr("has no effect, it counts only with run.barostat = \"c-rescale\""));
  const std::string gas = R"(hard_on = "nothing"
build = {kind = "molecules", box_nm = [3, 3, 3]}
[atom.A]
mass_u = 10
[molecule.dimer]
atoms = ["A", "A"]
bonds = [[0, 1, 0.1]]
[[place]]
molecule = "dimer"
count = 20
[run]
temperature_k = 300
)";
  EXPECT_EQ(complaint(gas, warm), "no error");
  EXPECT_THAT(complaint(gas, {warm[0], warm[1], "run.coupling=semi-isotropic"}),
              HasSubstr("run.coupling: no pairs of atoms act across the box, so nothing holds its shape"));
  EXPECT_THAT(complaint(SceneText{}.text, {"run.temperature_k=300", warm[0], warm[1]}),
              HasSubstr("run.barostat: there is no box to change; leave the key out"));
}

TEST(SceneErrors, MethodKeysWithoutEffect) {
  const auto idle = [&](std::vector<std::string> overrides) {
    const std::string message = complaint(kGood.text, overrides);
    const auto at = message.find("has no effect, it counts only ");
    return at == message.npos ? message : message.substr(at + 30);
  };
  EXPECT_EQ(idle({"method.reduction=0.1"}), "with method.gains = \"rattle\" or \"swept\"");
  EXPECT_EQ(idle({"method.gains=rattle", "method.reduction=0.1"}), "no error");
  EXPECT_THAT(complaint(kGood.text, {"method.gains=rattle", "method.reduction=0"}),
              testing::AllOf(HasSubstr("method.reduction"), HasSubstr("more than 0 and less than 1")));
  EXPECT_EQ(idle({"method.gains=hoomd", "method.damping=centred"}),
            "with other gains than \"hoomd\", whose drive is its own");
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

TEST(SceneErrors, Keys) {
  EXPECT_EQ(said("dt_fs", "dt_sf"), "scene.toml:16: unknown key \"dt_sf\" in [run]; did you mean \"dt_fs\"?");
  EXPECT_EQ(said("steps = 20", "temprature_k = 300"),
            "scene.toml:17: unknown key \"temprature_k\" in [run]; did you mean \"temperature_k\"?");
  EXPECT_EQ(said("max_solves", "max_slves"),
            "scene.toml:21: unknown key \"max_slves\" in [method]; did you mean \"max_solves\"?");
  EXPECT_THAT(said("max_solves", "omega_h"), HasSubstr("scene.toml:21: unknown key \"omega_h\" in"));
  EXPECT_EQ(said("[run]", "[rum]"), "scene.toml:15: unknown section \"rum\"; did you mean \"run\"?");
  EXPECT_EQ(said("gravity_nm_ps2", "gravity"),
            "scene.toml:13: unknown key \"gravity\" in [build]; did you mean \"gravity_nm_ps2\"?");
  EXPECT_THAT(said("[run]", "[forcefield]\ncutoff_nm = 1\n[run]"),
              HasSubstr("scene.toml:16: forcefield.cutoff_nm: has no effect, it counts only with pair"));
  EXPECT_EQ(said("[run]", "[forcefield]\ncutof_nm = 1\n[run]"),
            "scene.toml:16: unknown key \"cutof_nm\" in [forcefield]; did you mean \"cutoff_nm\"?");
  EXPECT_EQ(said("hard_on = \"a test\"", ""), "no error");
  EXPECT_THAT(said("kind = \"atoms\"", "kind = \"alkane\""),
              HasSubstr("build.kind: alkanes and rings are [molecule]s"));
  EXPECT_THAT(said("kind = \"atoms\"", ""), HasSubstr("scene.toml:2: build.kind: not said: place molecules"));
  EXPECT_THAT(complaint("hard_on = 'x'"), HasSubstr("scene.toml: build.kind: not said"));
}

TEST(SceneErrors, Values) {
  EXPECT_EQ(said("0.5", "\"fast\""), "scene.toml:16: run.dt_fs: expected a number, got a string");
  EXPECT_EQ(said("20", "2.5"), "scene.toml:17: run.steps: expected an integer, got a number");
  EXPECT_EQ(said("0.5", "0"), "scene.toml:16: run.dt_fs: expected more than 0, got 0");
  EXPECT_EQ(said("0.5", "nan"), "scene.toml:16: run.dt_fs: expected a finite number, got nan");
  EXPECT_EQ(said("steps = 20", "steps = -1"), "scene.toml:17: run.steps: expected at least 0, got -1");
  EXPECT_EQ(said("max_solves = 2", "max_solves = 1e10"), "scene.toml:21: method.max_solves: out of range");
  EXPECT_EQ(said("steps = 20", "steps = 1e30"), "scene.toml:17: run.steps: out of range");
  EXPECT_EQ(said("steps = 20", "thermostat_ps = 0.1"),
            "scene.toml:17: run.thermostat_ps: a thermostat needs a run.temperature_k above 0");
  EXPECT_EQ(said("steps = 20", "thermostat = \"langevin\""),
            "scene.toml:17: run.thermostat: a thermostat needs a run.temperature_k above 0");
  EXPECT_EQ(said("\"atoms\"", "\"atom\""),
            "scene.toml:3: build.kind: there is no \"atom\"; did you mean \"atoms\"?");
  EXPECT_THAT(said("\"baumgarte\"", "\"ratle\""),
              HasSubstr("scene.toml:19: method.name: there is no \"ratle\"; did you mean \"rattle\"?"));
  EXPECT_EQ(said("[0, -9.81, 0]", "[0, -9.81]"),
            "scene.toml:13: build.gravity_nm_ps2: expected three numbers [x, y, z], got an array");
  EXPECT_EQ(complaint("build = 3\nhard_on = ''"), "scene.toml:1: build: expected a section, got an integer");
}

TEST(SceneErrors, AtomsAndBonds) {
  EXPECT_THAT(said("[1, 2, 1]", "[1, 0, 2]"), HasSubstr("scene.toml:11: build.bonds[1]: repeats bonds[0]"));
  EXPECT_EQ(said("[1, 2, 1]", "[1, 3, 1]"), "scene.toml:11: build.bonds[1]: there is no atom 3, only 0 to 2");
  EXPECT_EQ(said("[1, 0, 0, 1]", "[1, 0, 0, 0]"),
            "scene.toml:10: build.bonds[0]: both its atoms are anchored (mass 0)");
  EXPECT_EQ(said("[1, 2, 1]", "[1, 2, 1, 4]"), "scene.toml:11: build.bonds[1]: expected 3 numbers, got 4");
  EXPECT_EQ(said("[1, 2, 1]", "[1, 2, inf]"), "scene.toml:11: build.bonds[1]: expected finite numbers");
  EXPECT_THAT(said("[1, 2, 1]", "7"), HasSubstr("scene.toml:11: build.bonds[1]: expected a row of numbers"));
  EXPECT_EQ(said("1.5]", "\"a\"]"), "scene.toml:7: build.atoms[2]: expected numbers, got a string");
  EXPECT_EQ(said("1.5]", "-1]"), "scene.toml:7: build.atoms[2]: expected a mass above 0, or 0 for an anchor");
  EXPECT_EQ(said("[2, 1, 2, 3]", "[3, 1, 2, 3]"),
            "scene.toml:14: build.pulls[0]: there is no atom 3, only 0 to 2");
  EXPECT_EQ(said("pulls", "velocities = [[0, 0, 0]]\npulls"),
            "scene.toml:14: build.velocities: expected one for each atom");
}

TEST(SceneErrors, StrutsRopesAndSprings) {
  const auto with = [&](const std::string& line) { return said("pulls", line + "\npulls"); };
  EXPECT_EQ(with("at_least = [[0, 2, 2]]\nat_most = [[0, 2, 2]]\nsprings = [[0, 2, 1, 5]]"), "no error");
  EXPECT_EQ(with("at_least = [[0, 2, 1], [0, 2, 2.5]]"),
            "scene.toml:14: build.at_least[1]: repeats at_least[0], the same two atoms");
  EXPECT_THAT(with("at_least = [[0, 2, 2.5]]"), HasSubstr("scene.toml:14: build.at_least[0]: atoms 0 and 2"));
  EXPECT_THAT(with("at_least = [[0, 2, 1]]\nat_most = [[0, 2, 1.5]]"),
              HasSubstr("scene.toml:15: build.at_most[0]: atoms 0 and 2 stand 2 nm apart at the start"));
  EXPECT_EQ(with("restraints = [[0, 0, 0, 0, 100]]"), "no error");
  const auto rope = kGood.with("pulls", "at_most = [[0, 2, 3]]\npulls");
  EXPECT_EQ(complaint(rope.text, {"method.name=lincs"}),
            "--set method.name=lincs: method.name: method \"lincs\" holds no one-sided bonds (at_least, "
            "at_most), and there "
            "are 1: expected none, baumgarte, shake, rattle");
  EXPECT_EQ(read(rope.text).method.name(), "rattle");
  EXPECT_THAT(complaint(rope.with("steps = 20", "minimise = true").text),
              HasSubstr("scene.toml:18: run.minimise: moves atoms through one-sided bonds (at_least"));
}

TEST(SceneErrors, CountsAndLengths) {
  EXPECT_EQ(complaint(kMelt, {"run.steps=0"}), "no error");
  const auto with = [](const char* old, const char* changed) {
    return complaint(SceneText{kMelt}.with(old, changed).text);
  };
  EXPECT_EQ(with("chains = 10", "chains = -10"), "scene.toml:4: build.chains: expected at least 1, got -10");
  EXPECT_THAT(with("chains = 10", "chains = 1e12"), HasSubstr("scene.toml:4: build.chains: 1000000000000"));
  EXPECT_THAT(with("beads = 20", "beads = 9000000000000000000"),
              HasSubstr("scene.toml:4: build.chains: 10 make 9e+19"));
  EXPECT_THAT(with("bond_nm = 0.97", "bond_nm = 0"), HasSubstr("scene.toml:6: build.bond_nm: expected more"));
  EXPECT_EQ(with("cutoff_nm = 2.5", "cutoff_nm = 3.5"),
            "scene.toml:14: forcefield.cutoff_nm: 3.5 is over half the box, 2.855");
  EXPECT_EQ(with("cutoff_nm = 2.5", ""), "scene.toml:10: missing key \"cutoff_nm\" in [forcefield]");
  EXPECT_EQ(with("cutoff_nm = 2.5", "cutoff_nm = 2.5\nswitch_nm = 2.6"),
            "scene.toml:15: forcefield.switch_nm: expected less than forcefield.cutoff_nm");
  EXPECT_THAT(with("cutoff_nm = 2.5", "cutoff_nm = 2.5\nrf_dielectric = 5"),
              HasSubstr("scene.toml:15: forcefield.rf_dielectric: has no effect, it counts only between"));
  EXPECT_EQ(with("cutoff_nm = 2.5", "cutoff_nm = 2.5\nprecision = \"single\""),
            "scene.toml:15: forcefield.precision: there is no \"single\"; expected one of double, mixed");
  EXPECT_EQ(with("cutoff_nm = 2.5", "cutoff_nm = 2.5\nprecision = \"mixed\""), "no error");
  EXPECT_THAT(with("0.85", "0.05"), HasSubstr("scene.toml:8: build.density_per_nm3: 0.05 is too low"));
  EXPECT_THAT(with("0.85", "5"), HasSubstr("scene.toml:8: build.density_per_nm3: 5 is too high"));
}

TEST(SceneErrors, Overrides) {
  EXPECT_EQ(complaint(kGood.text, {"run.dt_fs=abc"}),
            "--set run.dt_fs=abc: run.dt_fs: expected a number, got a string");
  EXPECT_EQ(complaint(kGood.text, {"run.dt=2"}),
            "--set run.dt=2: unknown key \"dt\" in [run]; did you mean \"dt_fs\"?");
  EXPECT_EQ(complaint(kGood.text, {"rum.dt_fs=2"}),
            "--set rum.dt_fs=2: unknown section \"rum\"; did you mean \"run\"?");
  EXPECT_EQ(
      complaint(kGood.text, {"build.molecules=2"}),
      "--set build.molecules=2: unknown key \"molecules\" in [build]; expected one of at_least, "
      "at_most, atoms, bonds, gravity_nm_ps2, kind, pulls, restraints, springs, start, steered, velocities");
  EXPECT_EQ(complaint(kGood.text, {"run.steps"}), "--set run.steps: expected key=value, such as run.dt_fs=2");
  EXPECT_EQ(complaint(kGood.text, {"=3"}), "--set =3: expected key=value, such as run.dt_fs=2");
  EXPECT_EQ(complaint(kGood.text, {"a b=3"}), "--set a b=3: expected key=value, such as run.dt_fs=2");
  EXPECT_EQ(complaint(kGood.text, {"run=3"}), "--set run=3: run: expected a section, got an integer");
  EXPECT_EQ(complaint(kGood.text, {"method.name=newton", "method.sweeps=1"}),
            "--set method.sweeps=1: unknown key \"sweeps\" in [method]; expected one of max_iterations, "
            "name, tolerance");
  EXPECT_THAT(complaint(kGood.text, {"method.name=newtom"}),
              HasSubstr("--set method.name=newtom: method.name: there is no \"newtom\"; did you mean"));
  EXPECT_EQ(complaint(kGood.text, {"build.bonds.1=[0, 1, 2]"}),
            "--set build.bonds.1=[0, 1, 2]: build.bonds[1]: repeats bonds[0], the same two atoms");
  EXPECT_EQ(complaint(kGood.text, {"build.bonds.2=[0, 1, 2]"}),
            "--set build.bonds.2=[0, 1, 2]: there is no \"2\" in a list of 2, counted from 0");
  EXPECT_EQ(complaint(kGood.text, {"build.bonds.one=[0, 1, 2]"}),
            "--set build.bonds.one=[0, 1, 2]: there is no \"one\" in a list of 2, counted from 0");
  EXPECT_EQ(complaint(kMelt, {"build.chains=1e12"}),
            "--set build.chains=1e12: build.chains: 1000000000000 make 20000000000000 atoms, more than the "
            "10000000 "
            "taut takes");
}

// The file and the overrides are one scene: each may complete the other, or leave a key of the other without effect.
TEST(SceneErrors, OfAFileThatOverridesComplete) {
  const std::string bath = kPolymers + "[run]\nthermostat = \"langevin\"\nfriction_per_ps = 2\n";
  const auto cold =
      HasSubstr("scene.toml:14: run.thermostat: a thermostat needs a run.temperature_k above 0");
  EXPECT_THAT(complaint(bath), cold);
  EXPECT_THAT(complaint(bath, {"run.seed=3"}), cold);
  EXPECT_EQ(read(bath, {"run.temperature_k=300"}).run.temperature_k, 300);
  EXPECT_EQ(complaint(bath, {"run.temperature_k=0"}),
            "--set run.temperature_k=0: run.temperature_k: a thermostat needs a run.temperature_k above 0");
  EXPECT_EQ(complaint(bath, {"run.thermostat=none"}), "no error");  // the friction is the file's
  EXPECT_THAT(complaint(bath, {"run.thermostat=none", "run.friction_per_ps=3"}),
              HasSubstr("--set run.friction_per_ps=3: run.friction_per_ps: has no effect"));

  const std::string rescaling =
      kPolymers + "[run]\nthermostat = \"rescaling\"\ntemperature_k = 300\nmetric_correction = true\n";
  EXPECT_THAT(complaint(rescaling), HasSubstr("scene.toml:14: run.thermostat: rescaling needs its"));
  EXPECT_EQ(complaint(rescaling, {"run.thermostat_ps=1"}), "no error");
  EXPECT_THAT(complaint(rescaling, {"run.thermostat_ps=0"}), HasSubstr("_ps=0: run.thermos"));
  EXPECT_EQ(complaint(kPolymers + "[run]\nmetric_correction = true\n", {"run.temperature_k=300"}),
            "no error");

  const std::string idle = kPolymers + "[run]\nfriction_per_ps = 2\n";
  for (const std::vector<std::string>& overrides : {std::vector<std::string>{}, {"run.steps=3"}})
    EXPECT_THAT(complaint(idle, overrides), HasSubstr("scene.toml:14: run.friction_per_ps: has no effect"));
  EXPECT_EQ(read(idle, {"run.thermostat=langevin", "run.temperature_k=300"}).run.friction_per_ps, 2);
  EXPECT_THAT(complaint(kPolymers + "run = 3\n", {"run.steps=3"}), HasSubstr("forcefield"));
  EXPECT_THAT(complaint("run = 3\n" + kPolymers, {"run.steps=3"}),
              HasSubstr("scene.toml:1: run: expected a section, got an integer"));
}

TEST(SceneErrors, Files) {
  EXPECT_THAT(complaint("time_ps = 0\natoms = [[0, 0, 0, 0, 0, 0]]"), HasSubstr("scene.toml: a start, not"));
  EXPECT_EQ(complaint("hard_on = \"a test\"\n[build\n").substr(0, 35), "scene.toml:2: not valid TOML: Error");
  EXPECT_THAT(complaint("\x01\x02 this is no TOML"), HasSubstr("scene.toml:1: not valid TOML"));
  EXPECT_THAT(complaint("<?xml version=\"1.0\"?>"), HasSubstr("scene.toml:1: not valid TOML"));
  EXPECT_THAT(complaint(""), HasSubstr("build.kind: not said"));
  EXPECT_THAT(complaint(SceneText{}.with("[run]", "start = \"nowhere.start.toml\"\n[run]").text),
              HasSubstr("nowhere.start.toml: no such file"));
  EXPECT_EQ(error_message([&] { read_scene("/nowhere/at/all.toml"); }), "/nowhere/at/all.toml: no such file");
}

// What only the system or the force field can find carries the file's name too.
TEST(SceneErrors, OfTheForceFieldNameTheFile) {
  const std::string small =
      SceneText{kMelt}.with("chains = 10", "chains = 1").with("beads = 20", "beads = 3").text;
  EXPECT_THAT(complaint(small, {"forcefield.pair=wca", "forcefield.cutoff_nm=1"}),
              HasSubstr("cutoff_nm: has no effect, it counts only with forcefield.pair"));
  EXPECT_THAT(complaint(small, {"forcefield.pair=wca"}), testing::StartsWith("scene.toml: "));
  EXPECT_THAT(complaint(SceneText{small}.with("cutoff_nm = 2.5", "").text, {"forcefield.pair=wca"}),
              testing::StartsWith("scene.toml: "));
}

}  // namespace
}  // namespace taut::scene_errors_tests
