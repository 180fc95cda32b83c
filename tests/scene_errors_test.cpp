// What every bad input of a scene is told, its molecules and their places among them: one line with the file, the
// line and the key.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "polymer_scene.hpp"
#include "scene_text.hpp"

namespace taut::scene_errors_tests {
namespace {

const SceneText kGood;

// What nothing reads, as the other keys are, is refused with what it takes; an override that makes a key of
// the file idle sets it aside.
TEST(SceneErrors, KeysWithoutEffect) {
  const std::string bath = "temperature_k = 300\nthermostat = \"langevin\"\n";
  expect_said(kGood,
              {{"steps = 20", "friction_per_ps = 1", "scene.toml:17: run.friction_per_ps: has no effect"},
               {"steps = 20", bath + "thermostat_ps = 1", "scene.toml:19: run.thermostat_ps: has"},
               {"steps = 20", bath + "friction_per_ps = 1", "no error"},
               {"steps = 20", "minimise_force_kj_mol_nm = 10", "with run.minimise = true"},
               {"steps = 20", "trajectory = \"h5md\"", "with run.trajectory_every above 0"},
               {"steps = 20", "trajectory_every = 5\ntrajectory = \"dcd\"", "no error"}});
  const SceneText langevin = kGood.with("steps = 20", bath + "friction_per_ps = 1");
  expect_said_of(langevin.text, {{{"run.thermostat=none"}, "no error"},
                                 {{"run.thermostat_ps=1"}, "thermostat_ps: has no effect"},
                                 {{"run.thermostat=none", "run.friction_per_ps=2"},
                                  "--set run.friction_per_ps=2: run.friction_per_ps: has no effect"}});
}

TEST(SceneErrors, BarostatsWithoutWhatTheyNeed) {
  const std::string water = R"(hard_on = "pressed"
build = {kind = "water", model = "tip3p", shape = "box", molecules = 216, density_g_cm3 = 0.99}
forcefield = {cutoff_nm = 0.9, rf_dielectric = 78.3}
[run]
temperature_k = 300
)";
  const std::string bath = "run.thermostat=langevin", rescaling = "run.barostat=c-rescale";
  expect_said_of(
      water,
      {{{rescaling}, "run.barostat: a barostat needs a thermostat"},
       {{bath, rescaling}, "no error"},
       {{bath, rescaling, "run.coupling=anisotropic"}, "no error"},
       {{bath, rescaling, "run.coupling=triclinic"}, "there is no \"triclinic\""},
       {{bath, rescaling, "run.compressibility_per_bar=0"}, "compressibility_per_bar: expected more than 0"},
       {{bath, rescaling, "run.barostat_every=0"}, "run.barostat_every: expected at least 1"},
       {{"run.pressure_bar=1"}, "counts only with run.barostat"},
       {{bath, "run.barostat=monte-carlo", "run.barostat_ps=1"}, "only with run.barostat = \"c-"}});
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
  expect_said_of(
      gas, {{{bath, rescaling}, "no error"},
            {{bath, rescaling, "run.coupling=semi-isotropic"}, "no pairs of atoms act across the box"}});
  expect_said_of(kGood.text, {{{"run.temperature_k=300", bath, rescaling}, "run.barostat: there is no box"}});
}

TEST(SceneErrors, MethodKeysWithoutEffect) {
  const std::string k = "has no effect, it counts only ";
  expect_said_of(
      kGood.text,
      {{{"method.reduction=0.1"}, k + "with method.gains = \"rattle\" or \"swept\""},
       {{"method.gains=rattle", "method.reduction=0.1"}, "no error"},
       {{"method.stiffness=1e5"}, k + "with method.gains = \"physical\""},
       {{"method.gains=physical", "method.stiffness=1e5"}, "no error"},
       {{"method.gains=physical", "method.stiffness=1e5", "method.beta_per_ps=1"},
        k + "without both alpha_per_ps"},
       {{"method.gains=numbers", "method.beta_per_ps=1"}, "no error"},
       {{"method.name=shake", "method.sweeps=3", "method.tolerance=1e-6"}, k + "without method.sweeps"},
       {{"method.name=rattle", "method.sweeps=3", "method.max_sweeps=6"}, k + "without method.sweeps"},
       {{"method.name=rattle", "method.max_sweeps=6", "method.tolerance=1e-6"}, "no error"},
       {{"method.name=penalty", "method.k=1e4", "method.omega_h=0.1"}, k + "without method.k"}});
}

TEST(SceneErrors, Keys) {
  expect_said(kGood,
              {{"dt_fs", "dt_sf", "scene.toml:16: unknown key \"dt_sf\" in [run]; did you mean \"dt_fs\"?"},
               {"max_solves", "omega_h", "scene.toml:21: unknown key \"omega_h\" in"},
               {"[run]", "[rum]", "scene.toml:15: unknown section \"rum\"; did you mean \"run\"?"},
               {"gravity_nm_ps2", "gravity", "scene.toml:13: unknown key \"gravity\" in [build]"},
               {"[run]", "[forcefield]\ncutoff_nm = 1\n[run]", "scene.toml:16: forcefield.cutoff_nm: has no"},
               {"[run]", "[forcefield]\ncutof_nm = 1\n[run]", "scene.toml:16: unknown key \"cutof_nm\""},
               {"hard_on = \"a test\"", "", "no error"},
               {"kind = \"atoms\"", "kind = \"alkane\"", "build.kind: alkanes and rings are [molecule]s"},
               {"kind = \"atoms\"", "", "scene.toml:2: build.kind: not said"}});
}

TEST(SceneErrors, Values) {
  expect_said(kGood,
              {{"0.5", "\"fast\"", "scene.toml:16: run.dt_fs: expected a number, got a string"},
               {"20", "2.5", "scene.toml:17: run.steps: expected an integer"},
               {"0.5", "0", "scene.toml:16: run.dt_fs: expected more than 0, got 0"},
               {"0.5", "nan", "scene.toml:16: run.dt_fs: expected a finite number"},
               {"steps = 20", "steps = -1", "scene.toml:17: run.steps: expected at least 0"},
               {"max_solves = 2", "max_solves = 1e10", "scene.toml:21: method.max_solves: out of range"},
               {"steps = 20", "thermostat_ps = 0.1", "scene.toml:17: run.thermostat_ps: a thermostat needs"},
               {"steps = 20", "thermostat = \"langevin\"", "run.thermostat: a thermostat needs a run.temp"},
               {"\"atoms\"", "\"atom\"", "scene.toml:3: build.kind: there is no \"atom\"; did you mean"},
               {"\"baumgarte\"", "\"ratle\"", "scene.toml:19: method.name: there is no \"ratle\""},
               {"[0, -9.81, 0]", "[0, -9.81]", "build.gravity_nm_ps2: expected three numbers"}});
}

TEST(SceneErrors, AtomsAndBonds) {
  expect_said(kGood,
              {{"[1, 2, 1]", "[1, 0, 2]", "scene.toml:11: build.bonds[1]: repeats bonds[0]"},
               {"[1, 2, 1]", "[1, 3, 1]", "build.bonds[1]: there is no atom 3, only 0 to 2"},
               {"[1, 0, 0, 1]", "[1, 0, 0, 0]", "scene.toml:10: build.bonds[0]: both its atoms are anchored"},
               {"[1, 2, 1]", "[1, 2, 1, 4]", "build.bonds[1]: expected 3 numbers, got 4"},
               {"[1, 2, 1]", "[1, 2, inf]", "build.bonds[1]: expected finite numbers"},
               {"[1, 2, 1]", "7", "scene.toml:11: build.bonds[1]: expected a row of numbers"},
               {"1.5]", "\"a\"]", "scene.toml:7: build.atoms[2]: expected numbers, got a string"},
               {"1.5]", "-1]", "scene.toml:7: build.atoms[2]: expected a mass above 0"},
               {"[2, 1, 2, 3]", "[3, 1, 2, 3]", "scene.toml:14: build.pulls[0]: there is no atom 3"},
               {"pulls", "velocities = [[0, 0, 0]]\npulls", "build.velocities: expected one for each atom"}});
}

TEST(SceneErrors, StrutsRopesAndSprings) {
  const SceneText open = kGood.with("pulls", "@\npulls");
  expect_said(
      open,
      {{"@", "at_least = [[0, 2, 2]]\nat_most = [[0, 2, 2]]\nsprings = [[0, 2, 1, 5]]", "no error"},
       {"@", "at_least = [[0, 2, 1], [0, 2, 2.5]]", "build.at_least[1]: repeats at_least[0]"},
       {"@", "at_least = [[0, 2, 2.5]]", "scene.toml:14: build.at_least[0]: atoms 0 and 2"},
       {"@", "at_least = [[0, 2, 1]]\nat_most = [[0, 2, 1.5]]", "build.at_most[0]: atoms 0 and 2 stand"},
       {"@", "restraints = [[0, 0, 0, 0, 100]]", "no error"}});
  const SceneText rope = open.with("@", "at_most = [[0, 2, 3]]");
  expect_said_of(rope.text,
                 {{{"method.name=lincs"},
                   "method \"lincs\" holds no one-sided bonds (at_least, at_most), and there are 1: "
                   "expected none, baumgarte, shake, rattle"}});
  const std::string by_default = rope.text.substr(0, rope.text.find("[method]"));
  EXPECT_EQ(read(by_default).method.name(), "rattle");
  EXPECT_EQ(read(by_default + "[method]\nmax_sweeps = 77\n").method.name(), "rattle");
  expect_said(rope, {{"steps = 20", "minimise = true", "run.minimise: moves atoms through one-sided bonds"}});
}

TEST(SceneErrors, CountsAndLengths) {
  const SceneText melt{kMelt};
  const auto also = [](const char* key) { return std::string("cutoff_nm = 2.5\n") + key; };
  expect_said(
      melt, {{"chains = 10", "chains = -10", "scene.toml:4: build.chains: expected at least 1"},
             {"chains = 10", "chains = 1e12", "scene.toml:4: build.chains: 1000000000000"},
             {"beads = 20", "beads = 9000000000000000000", "scene.toml:4: build.chains: 10 make 9e+19"},
             {"bond_nm = 0.97", "bond_nm = 0", "scene.toml:6: build.bond_nm: expected more"},
             {"cutoff_nm = 2.5", "cutoff_nm = 3.5", "forcefield.cutoff_nm: 3.5 is over half the box"},
             {"cutoff_nm = 2.5", "", "scene.toml:10: missing key \"cutoff_nm\" in [forcefield]"},
             {"cutoff_nm = 2.5", also("switch_nm = 2.6"), "switch_nm: expected less than forcefield.cutoff"},
             {"cutoff_nm = 2.5", also("rf_dielectric = 5"), "rf_dielectric: has no effect"},
             {"cutoff_nm = 2.5", also("precision = \"single\""), "there is no \"single\"; expected one of"},
             {"cutoff_nm = 2.5", also("precision = \"mixed\""), "no error"},
             {"0.85", "0.05", "scene.toml:8: build.density_per_nm3: 0.05 is too low"},
             {"0.85", "5", "scene.toml:8: build.density_per_nm3: 5 is too high"}});
}

TEST(SceneErrors, Overrides) {
  expect_said_of(
      kGood.text,
      {{{"run.dt_fs=abc"}, "--set run.dt_fs=abc: run.dt_fs: expected a number, got a string"},
       {{"run.dt=2"}, "--set run.dt=2: unknown key \"dt\" in [run]; did you mean \"dt_fs\"?"},
       {{"rum.dt_fs=2"}, "unknown section \"rum\"; did you mean \"run\"?"},
       {{"build.molecules=2"}, "unknown key \"molecules\" in [build]; expected one of at_least, at_most"},
       {{"run.steps"}, "--set run.steps: expected key=value"},
       {{"=3"}, "--set =3: expected key=value"},
       {{"run=3"}, "--set run=3: run: expected a section"},
       {{"method.name=newton", "method.sweeps=1"}, "unknown key \"sweeps\" in [method]"},
       {{"build.bonds.1=[0, 1, 2]"}, "build.bonds[1]: repeats bonds[0], the same two atoms"},
       {{"build.bonds.2=[0, 1, 2]"}, "there is no \"2\" in a list of 2, counted from 0"},
       {{"build.bonds.one=[0, 1, 2]"}, "there is no \"one\" in a list of 2"}});
}

// The file and the overrides are one scene: each may complete the other, or leave a key of the other without effect.
TEST(SceneErrors, OfAFileThatOverridesComplete) {
  const std::string cold = "scene.toml:14: run.thermostat: a thermostat needs a run.temperature_k above 0";
  const std::string bath = kPolymers + "[run]\nthermostat = \"langevin\"\nfriction_per_ps = 2\n";
  EXPECT_EQ(read(bath, {"run.temperature_k=300"}).run.temperature_k, 300);
  expect_said_of(bath,
                 {{{}, cold},
                  {{"run.seed=3"}, cold},
                  {{"run.temperature_k=0"}, "--set run.temperature_k=0: run.temperature_k: a thermostat"},
                  {{"run.thermostat=none"}, "no error"},  // the friction is the file's
                  {{"run.thermostat=none", "run.friction_per_ps=3"}, "run.friction_per_ps: has no effect"}});
  const std::string keys =
      "[run]\nthermostat = \"rescaling\"\ntemperature_k = 300\nmetric_correction = true\n";
  expect_said_of(kPolymers + keys, {{{}, "scene.toml:14: run.thermostat: rescaling needs its"},
                                    {{"run.thermostat_ps=1"}, "no error"},
                                    {{"run.thermostat_ps=0"}, "_ps=0: run.thermos"}});
  const std::string idle = kPolymers + "[run]\nfriction_per_ps = 2\n";
  expect_said_of(idle, {{{"run.steps=3"}, "scene.toml:14: run.friction_per_ps: has no effect"}});
  EXPECT_EQ(read(idle, {"run.thermostat=langevin", "run.temperature_k=300"}).run.friction_per_ps, 2);
  expect_said_of("run = 3\n" + kPolymers, {{{"run.steps=3"}, "scene.toml:1: run: expected a section"}});
}

TEST(SceneErrors, Files) {
  expect_said_of("time_ps = 0\natoms = [[0, 0, 0, 0, 0, 0]]", {{{}, "scene.toml: a start, not"}});
  expect_said_of("hard_on = \"a test\"\n[build\n", {{{}, "scene.toml:2: not valid TOML: Error"}});
  expect_said_of("\x01\x02 this is no TOML", {{{}, "scene.toml:1: not valid TOML"}});
  expect_said_of("", {{{}, "build.kind: not said"}});
  expect_said(kGood,
              {{"[run]", "start = \"nowhere.start.toml\"\n[run]", "nowhere.start.toml: no such file"}});
  EXPECT_EQ(error_message([&] { read_scene("/nowhere/at/all.toml"); }), "/nowhere/at/all.toml: no such file");
}

// What only the system or the force field can find carries the file's name too.
TEST(SceneErrors, OfTheForceFieldNameTheFile) {
  const std::string small =
      SceneText{kMelt}.with("chains = 10", "chains = 1").with("beads = 20", "beads = 3").text;
  EXPECT_THAT(complaint(small, {"forcefield.pair=wca"}), testing::StartsWith("scene.toml: "));
}

const SceneText kChain{R"([atom.C]
mass_u = 12
[molecule.chain]
atoms = ["C", {name = "B", mass_u = 72, sigma_nm = 0.47, epsilon_kj_mol = 3.5}]
bonds = [[0, 1, 0.35]]
[[place]]
molecule = "chain"
count = 3
[build]
box_nm = 5
[forcefield]
cutoff_nm = 1.1
)"};

TEST(MoleculeErrors, Atoms) {
  expect_said_of(kChain.text,
                 {{{}, "no error"}, {{"molecule.chian.units=3"}, "there is no [molecule.chian]; did you"}});
  expect_said(
      kChain,
      {{"[\"C\"", "[\"D\"", "scene.toml:4: molecule.chain.atoms: there is no [atom.D]; did you mean"},
       {"[\"C\"", "[3", "scene.toml:4: molecule.chain.atoms[0]: expected a section, got an integer"},
       {"mass_u = 72", "mass = 72", "scene.toml:4: missing key \"mass_u\""},
       {"mass_u = 72", "mass_u = -72", "molecule.chain.atoms.1.mass_u: expected at least 0"},
       {"mass_u = 12", "mass_u = 12\nmas = 1", "scene.toml:3: unknown key \"mas\" in [atom.C]; did you"},
       {"\"B\"", "\"B\\n\"", "molecule.chain.atoms.1.name: expected a name of letters"},
       {"bonds", "residue = \"ß\"\nbonds", "residue: expected a name of letters"},
       {"0.35]]", "0.35]]\nunit = 5", "scene.toml:6: unknown key \"unit\" in [molecule.chain]; did you"},
       {", sigma_nm = 0.47", "", "atoms.1.epsilon_kj_mol: needs a sigma_nm beside it"},
       {"bonds", "units = 1e9\nbonds", "molecule.chain.units: 1000000000 of 2 atoms are more"},
       {"bonds = [[0, 1, 0.35]]", "", "molecule.chain.atoms: nothing ties"}});
}

TEST(MoleculeErrors, Rows) {
  const char* row = "[0, 1, 0.35]";
  expect_said(
      kChain,
      {{row, "[0, 2, 0.35]", "scene.toml:5: molecule.chain.bonds[0]: there is no atom 2, only 0 to 1"},
       {row, "[1, 1, 0.35]", "molecule.chain.bonds[0]: names the same atom twice"},
       {row, "[0, 1.5, 0.35]", "molecule.chain.bonds[0]: expected atoms' indices, counted from 0"},
       {row, "[0, -3, 0.35]", "molecule.chain.bonds[0]: there is no atom -3, only 0 to 1"},
       {row, "[1, -1, 0.35]", "molecule.chain.bonds[0]: names the same atom twice"},
       {row, "[0, 1, 0]", "molecule.chain.bonds[0]: expected a length above 0"},
       {row, "[0, 1]", "molecule.chain.bonds[0]: expected 3 numbers, got 2"},
       {row, "[0, 1, 0.35],\n[1, 0, 0.3]", "scene.toml:6: molecule.chain.bonds[1]: repeats bonds[0]"}});
  const SceneText open = kChain.with("[[place]]", "@\n[[place]]");
  expect_said(
      open,
      {{"@", "springs = [[0, 1, 0.3, -1]]", "springs[0]: expected a length and a k of 0 or more"},
       {"@", "fene = [[0, 1, 30, 0]]", "fene[0]: expected k, and r0 above 0"},
       {"@", "angles = [[0, 1, 2, 120, 1]]", "angles[0]: there is no atom 2, only 0 to 1"},
       {"@", "units = 2\nangles = [[0, 1, 2, 200, 1]]", "expected an angle of 0 to 180 degrees"},
       {"@", "units = 2\ntorsions = [[0, 1, 2, 3, 1.5, 0, 1]]", "expected a periodicity of 1 to 64"},
       {"@", "units = 2\nangles = [[2, 3, 4, 100, 1]]", "there is no atom 4"},
       {"@", "units = 2\npulls = [[2, 1, 1, 1]]", "count from the end of all 4 atoms, -2 in place of 2"},
       {"@", "restraints = [[0, 0, 0, 0, -1]]", "restraints[0]: expected a stiffness of 0 or more"},
       {"@", "cmap = [[0, 1, 2, 3, 4]]", "molecule.chain.cmap: is read of OpenMM's files alone"},
       {"@", "exclude = \"1-5\"", "exclude: there is no \"1-5\"; did you mean \"1-2\"?"},
       {"@", "exclude = \"1-4\"\ncoulomb_14 = 0.5", "only where exclude is not \"1-4\""},
       {"@", "ring = true", "ring: has no effect, it counts only with units"},
       {"@", "coordinates_nm = [[0, 0, 0]]", "coordinates_nm: 1 atoms, expected 2"},
       {"@", "coordinates_nm = [[0, 0, 0], [1, 0, 0]]", "are 1 nm apart, their bond is 0.35"},
       {"@", "file = \"none.pdb\"", "none.pdb: no such file"}});
}

// A strut that starts too short, a rope too long, and what can never be.
TEST(MoleculeErrors, StrutsAndRopes) {
  const SceneText open = kChain.with("[[place]]", "@\n[[place]]"), three = open.with("@", "units = 2\n@");
  expect_said(open,
              {{"@", "at_most = [[0, 1, 0.3]]", "at_most[0]: its atoms are tied by a rigid bond already"},
               {"@", "at_least = [[0, 2, 0.3]]", "at_least[0]: there is no atom 2, only 0 to 1"},
               {"@", "at_least = [[0, 1, 0]]", "at_least[0]: expected a length above 0"}});
  const SceneText straight = three.with("@",
                                        "springs = [[0, 2, 0.4, 0]]\ncoordinates_nm = [[0, 0, 0], [0.35, 0, "
                                        "0], [0, 0.4, 0], [0.35, 0.4, 0]]\n@");
  expect_said(straight, {{"@", "at_least = [[0, 2, 0.4]]\nat_most = [[1, 3, 0.4]]", "no error"},
                         {"@", "at_least = [[0, 2, 0.5]]", "coordinates_nm: atoms 0 and 2 stand 0.4"},
                         {"@", "at_most = [[0, 2, 0.3]]", "more than the 0.3 nm of this rope"},
                         {"@", "at_least = [[0, 2, 0.4]]\nat_most = [[0, 2, 0.3]]",
                          "shorter than the strut of 0.4 nm"}});
  expect_said(three, {{"@", "springs = [[0, 2, 0.3, 100]]\nat_least = [[0, 2, 0.5]]", "no error"},  // pressed
                      {"@", "springs = [[1, 2, 0.3, 100]]\nat_least = [[0, 2, 0.9]]", "no shape found"}});
}

// No three sides of 1, 1 and 3, and no point as near to three corners.
TEST(MoleculeErrors, NoShapeHasAllItsBonds) {
  const SceneText flat{R"([molecule.flat]
atoms = [{name = "A", mass_u = 1}, {name = "B", mass_u = 1}, {name = "C", mass_u = 1}]
bonds = [[0, 1, 1], [1, 2, 1], [0, 2, 3]]
[[place]]
molecule = "flat"
count = 1
)"};
  expect_said_of(flat.text,
                 {{{}, "scene.toml: bond 2 (0-2): lengths 1, 1 and 3 nm close no triangle (0-1-2)"}});
  expect_said(flat.with("[0, 2, 3]", "[0, 2, 1], [0, 3, 0.55], [1, 3, 0.55], [2, 3, 0.55]"),
              {{"\"C\", mass_u = 1}", "\"C\", mass_u = 1}, {name = \"D\", mass_u = 1}",
                "molecule.flat: no shape found"}});
}

TEST(MoleculeErrors, Places) {
  const auto within = [](const char* corners) { return std::string("count = 3\nwithin_nm = ") + corners; };
  expect_said(
      kChain,
      {{"\"chain\"", "\"chian\"", "scene.toml:7: place.0.molecule: there is no \"chian\"; did you mean"},
       {"count = 3", "", "scene.toml:6: missing key \"count\" in [place.0]"},
       {"count = 3", "count = 0", "scene.toml:8: place.0.count: expected at least 1, got 0"},
       {"count = 3", "count = 6e6", "scene.toml:6: place.0: makes it 1.2e+07 atoms, more than the"},
       {"count = 3", "count = 1e300", "scene.toml:8: place.0.count: out of range"},
       {"count = 3", within("[0, 0, 0, 1, 1]"), "scene.toml:9: place.0.within_nm: expected six numbers"},
       {"count = 3", within("[0, 0, 2, 1, 1, 1]"), "the upper corner is below the lower"},
       {"count = 3", within("[0, 2, 1, 0, 2, 1]"), "both corners are one point"},
       {"count = 3", within("[0, 0, 2, 5, 5, 2]"), "no error"},
       {"\"chain\"\ncount = 3", "\"tip3p\"\nwithin_nm = [0, 0, 0, 1, 1, 1]", "water without a count"},
       {"[[place]]", "[place]", "scene.toml:6: place: expected a list of"},
       {"box_nm = 5", "box_nm = 5\nmolecules = 3", "copies are counted where they are placed"},
       {"count = 3", "count = 3\ncoutn = 4", "scene.toml:9: unknown key \"coutn\" in [place.0]; did you"},
       {"box_nm = 5", "box_nm = 0.7\n[molecule.idle]\natoms = [\"C\"]", "no [[place]] has it"},
       {"box_nm = 5", "kind = \"chains\"", "only with build.kind = \"molecules\""},
       {"box_nm = 5", "kind = \"molecules\"\nbox_nm = 5", "no error"}});
  // three balls of 0.94 nm do not go into a cube of 1
  expect_said(kChain.with("box_nm = 5", "box_nm = 1").with("0.47", "0.94"),
              {{"1.1", "0.5", "scene.toml:6: place.0: there is no room for copy 3 of 3 of \"chain\""}});
}

TEST(MoleculeErrors, Boxes) {
  const char* box = "box_nm = 5";
  expect_said(kChain,
              {{box, "box_nm = -5", "scene.toml:10: build.box_nm: expected more than 0"},
               {box, "box_nm = [5, 5]", "expected 3 numbers, its edges, or 9, its vectors; got 2"},
               {box, "box_nm = 5\ndensity_g_cm3 = 1", "build.density_g_cm3: has no effect"},
               {box, "box_nm = [5, 5, 5]\nbox = \"octahedron\"", "scene.toml:11: build.box: has no effect"},
               {box, "density_per_nm3 = 0.1", "no error"},
               {box, "[[place]]\nmolecule = \"tip3p\"", "place.1: water without a count fills a box"},
               {box, "box_nm = 1000\n[[place]]\nmolecule = \"tip3p\"", "more than taut takes"}});
}

}  // namespace
}  // namespace taut::scene_errors_tests
