// Tables of energies in files: how they are read, what their forces are held against, and scenes that name them.

#include <fmt/format.h>

#include <cmath>

#include "forcefield/force_field.hpp"
#include "md/units.hpp"
#include "scene_energy.hpp"
#include "scene_text.hpp"
#include "simulation/simulation.hpp"
#include "systems/scene/scene_source.hpp"

namespace taut::energy_table_tests {
namespace {

using testing::HasSubstr;

// E = 5000(r − 0.3)² with its force, and E = 0.01(θ − 120)² of degrees.
std::string bond_table(double force_scale = 1) {
  std::string text = "r_nm,energy_kj_mol,force_kj_mol_nm\n";
  for (int k = 0; k <= 40; ++k) {
    const double r = 0.2 + 0.005 * k, off = r - 0.3;
    text += fmt::format("{:.4f},{:.6f},{:.4f}\n", r, 5000 * off * off, -10000 * force_scale * off);
  }
  return text;
}
std::string angle_table() {
  std::string text = "# degrees, kJ/mol\n";
  for (int k = 0; k <= 180; ++k) text += fmt::format("{} {:.6f}\n", k, 0.01 * (k - 120) * (k - 120));
  return text;
}

const std::string kScene = R"(place = [{molecule = "cg", count = 3}]
build = {box_nm = 5}
forcefield = {cutoff_nm = 1.1}
run = {dt_fs = 2, steps = 500, temperature_k = 300}
[molecule.cg]
atoms = [{name = "B", mass_u = 72, sigma_nm = 0.3, epsilon_kj_mol = 1}]
units = 6
tables = [{file = "bond.csv", bonds = [[0, 1]]}, {file = "angle.csv", angles = [[0, 1, 2]]}]
)";

struct Folder {
  TemporaryFolder folder;
  Folder(const std::string& bond = bond_table(), const std::string& angle = angle_table()) {
    folder.write("bond.csv", bond);
    folder.write("angle.csv", angle);
  }
  Scene read(const std::string& text = kScene) const { return read_scene(folder.write("scene.toml", text)); }
  std::string said(const std::string& text = kScene) const {
    return folder.without_path(error_message([&] { read(text); }));
  }
};

double energy(const Scene& scene, const std::string& name) {
  for (const auto& [term, value] : energies_of(scene))
    if (term == name) return value;
  return NAN;
}

TEST(EnergyTable, MakesBondsAndAnglesOfAScene) {
  const Folder files;
  const Scene scene = files.read();
  EXPECT_EQ(scene.terms.tabulated_bonds.size(), 15u);
  EXPECT_EQ(scene.terms.tabulated_angles.size(), 12u);
  EXPECT_EQ(scene.terms.nonbonded->exceptions.size(), 27u);  // exclude = "1-3", along tables too
  // grown where the tables are least
  EXPECT_NEAR(energy(scene, "tabulated_bond"), 0, 1e-9);
  EXPECT_NEAR(energy(scene, "tabulated_angle"), 0, 1e-9);
  Scene moved = scene;
  const Vec3 along = (moved.start.x.col(1) - moved.start.x.col(0)).normalized();
  moved.start.x.col(0) -= 0.03 * along;
  EXPECT_NEAR(energy(moved, "tabulated_bond"), 5000 * 0.03 * 0.03, 1e-5);
  // made again from what was read, wherever it now is
  ASSERT_EQ(scene.files.size(), 3u);
  EXPECT_EQ(source_of(scene, {}).read().start.x, scene.start.x);
  // rigid bonds may hold what a table bends
  const Scene held = files.read(
      SceneText{kScene}
          .with("tables = [{file = \"bond.csv\", bonds = [[0, 1]]}, ", "bonds = [[0, 1, 0.3]]\ntables = [")
          .text);
  EXPECT_EQ(held.system.bond_count(), 15);
  EXPECT_EQ(held.terms.tabulated_angles.size(), 12u);
}

TEST(EnergyTable, ConservesTheEnergyOfARun) {
  Scene scene = Folder().read();
  Simulation simulation(std::move(scene));
  const double before = simulation.record().total();
  simulation.run([](const Record&) {});
  EXPECT_NEAR(simulation.record().total(), before, 0.05);  // of 65 kJ/mol kinetic
  EXPECT_GT(simulation.record().potential, 1);
}

TEST(EnergyTable, ForcesAreHeldAgainstEnergies) {
  EXPECT_EQ(Folder().said(), "no error");
  EXPECT_THAT(Folder(bond_table(-1)).said(),
              HasSubstr("scene.toml:8: molecule.cg.tables.0.file: bond.csv:3: the forces around 0.205 nm"));
  EXPECT_THAT(Folder(bond_table(0.95)).said(), HasSubstr("bond.csv:3: the forces around"));
  EXPECT_EQ(Folder(bond_table(0.995)).said(), "no error");
  // one energy of all is wrong
  EXPECT_THAT(Folder(SceneText{bond_table()}.with("0.3500,12.500000", "0.3500,13.500000").text).said(),
              HasSubstr("bond.csv:31: the forces around 0.345 nm"));
  // angles' forces are of degrees
  std::string angle;
  for (int k = 0; k <= 180; ++k)
    angle += fmt::format("{} {} {}\n", k, 0.01 * (k - 120) * (k - 120), -0.02 * (k - 120));
  EXPECT_EQ(Folder(bond_table(), angle).said(), "no error");
  std::string of_radians;
  for (int k = 0; k <= 180; ++k)
    of_radians += fmt::format("{} {} {}\n", k, 0.01 * (k - 120) * (k - 120), -0.02 * (k - 120) * 180 / M_PI);
  EXPECT_THAT(Folder(bond_table(), of_radians).said(), HasSubstr("kJ/mol/degree"));
}

TEST(EnergyTable, ThatIsNoneIsRefusedByFileAndLine) {
  for (const auto& [bond, words] : {std::pair{"0.2 1\n0.3 0\n", "bond.csv:1: has 2 rows, expected 3 or more"},
                                    {"0.2 1\n0.3 0\n0.4 x\n", "bond.csv:3: expected numbers, got \"0.4 x\""},
                                    {"0.2 1\n0.3 nan\n0.4 1\n", "bond.csv:2: expected numbers"},
                                    {"0.2 1\n0.3 0 1\n0.4 1\n", "bond.csv:2: has 3 numbers, expected 2"},
                                    {"1 0.2 1 0\n2 0.3 0 1\n3 0.4 1 2\n", "if it is a table of LAMMPS's"},
                                    {"0.2 1\n0.31 0\n0.4 1\n", "bond.csv:2: 0.31 nm, expected 0.3"},
                                    {"0.4 1\n0.3 0\n0.2 1\n", "bond.csv:3: the table does not rise"},
                                    {"-0.1 1\n0.3 0\n0.7 1\n", "bond.csv:1: a distance of -0.1 nm"}})
    EXPECT_THAT(Folder(bond).said(), HasSubstr(words));
  EXPECT_THAT(Folder(bond_table(), "0 1\n100 0\n200 1\n").said(), HasSubstr("angle.csv:3: an angle of 200"));
  for (const auto& [old, changed, words] :
       {Change{"bond.csv", "bend.csv", "bend.csv: cannot be read"},
        {", bonds = [[0, 1]]", "", "tables.0.file: expected bonds = [[0, 1]] or angles"},
        {"bonds = [[0, 1]]", "bonds = [[0, 9]]", "there is no atom 9"},
        {"bonds = [[0, 1]]", "bands = [[0, 1]]", "unknown key \"bands\" in [molecule.cg.tables.0]"}})
    EXPECT_THAT(Folder().said(SceneText{kScene}.with(old, changed).text), HasSubstr(words));
}

// What starts outside its table is refused with the place.
TEST(EnergyTable, RefusesAStartOutsideIt) {
  const std::string shaped =
      SceneText{kScene}
          .with("units = 6", "coordinates_nm = [[0, 0, 0], [0.3, 0, 0], [0.72, 0.1, 0]]\nunits = 3")
          .text;
  EXPECT_THAT(Folder().said(shaped), HasSubstr("scene.toml: tabulated bond 1-2 is 0.431741 nm long, its"));
}

// Soft beads A among hard ones B.
const std::string kMixture = R"(atom.A = {mass_u = 72, sigma_nm = 0.45, epsilon_kj_mol = 1}
atom.B = {mass_u = 72, sigma_nm = 0.4, epsilon_kj_mol = 2}
molecule.cg = {atoms = ["A", "B"], units = 2, springs = [[0, 1, 0.4, 3000], [1, 2, 0.4, 3000]]}
place = [{molecule = "cg", count = 30}]
pair = [{atoms = ["B", "A"], table = "pair.csv"}]
build = {box_nm = 4}
forcefield = {cutoff_nm = 1.1, switch_nm = 0.9}
run = {dt_fs = 5, steps = 400, temperature_k = 300}
)";

// 25 (1 − r/0.8)² with its force
std::string pair_table(double end = 0) {
  std::string text;
  for (int k = 0; k <= 160; ++k) {
    const double r = 0.005 * k, off = 1 - r / 0.8;
    text += fmt::format("{:.4f} {:.8f} {:.6f}\n", r, 25 * off * off + end, 50 / 0.8 * off);
  }
  return text;
}

struct PairFolder : Folder {
  explicit PairFolder(const std::string& pair = pair_table()) { folder.write("pair.csv", pair); }
};

TEST(EnergyTable, OfPairsTakesThePlaceOfLennardJones) {
  const PairFolder files;
  const Scene scene = files.read(kMixture);
  const auto& pairs = *scene.terms.tabulated_pairs;
  ASSERT_EQ(pairs.potentials.size(), 1u);
  EXPECT_EQ(pairs.exclusions.size(), 30u * 5);  // 1-2 and 1-3
  const LennardJonesTable& rest = *scene.terms.nonbonded->lj_table;
  EXPECT_EQ(rest.b(0, 1), 0);
  EXPECT_GT(rest.b(0, 0) * rest.b(1, 1), 0);
  double expected = 0;
  for (int i = 0; i < 120; ++i)
    for (int j = i + 1; j < 120; ++j) {
      const double r = scene.start.box.nearest_image(scene.start.x.col(j) - scene.start.x.col(i)).norm();
      if ((i - j) % 2 != 0 && r < 0.8 && !(i / 4 == j / 4 && j - i < 3))
        expected += 25 * std::pow(1 - r / 0.8, 2);
    }
  EXPECT_GT(expected, 10);
  EXPECT_NEAR(energy(scene, "tabulated_pairs"), expected, 1e-5 * expected);
  ASSERT_EQ(scene.files.size(), 2u);
  EXPECT_EQ(source_of(scene, {}).read().start.x, scene.start.x);
  Simulation simulation{Scene(scene)};
  const double before = simulation.record().total();
  simulation.run([](const Record&) {});
  EXPECT_NEAR(simulation.record().total(), before, 0.2);  // of 450 kJ/mol kinetic
}

TEST(EnergyTable, OfAllPairsLeavesNoLennardJones) {
  const PairFolder files;
  const std::string all = SceneText{kMixture}
                              .with("table = \"pair.csv\"}",
                                    "table = \"pair.csv\"}, {atoms = [\"A\", \"A\"], table = \"pair.csv\"}, "
                                    "{atoms = [\"B\", \"B\"], table = \"pair.csv\"}")
                              .with("cutoff_nm = 1.1, switch_nm = 0.9", "precision = \"mixed\"")
                              .text;
  const Scene scene = files.read(all);
  EXPECT_FALSE(scene.terms.nonbonded);
  EXPECT_EQ(scene.terms.tabulated_pairs->potentials.size(), 3u);
  EXPECT_EQ(scene.terms.precision, Precision::kMixed);
  EXPECT_THAT(files.said(SceneText{all}.with("precision = \"mixed\"", "cutoff_nm = 1.1").text),
              HasSubstr("all pairs have tables here, which end where they end"));
}

TEST(EnergyTable, OfPairsSaysWhatIsWrong) {
  const SceneText scene{kMixture};
  const auto said = [](const SceneText& text, const std::string& table = pair_table()) {
    return PairFolder(table).said(text.text);
  };
  EXPECT_EQ(said(scene), "no error");
  EXPECT_THAT(said(scene, pair_table(0.5)), HasSubstr("pair.0.table: pair.csv ends with 0.5 kJ/mol at 0.8"));
  EXPECT_EQ(said(scene.with("\"pair.csv\"", "\"pair.csv\", shift = true"), pair_table(0.5)), "no error");
  EXPECT_THAT(said(scene.with("\"pair.csv\"", "\"pair.csv\", sigma_nm = 0.3")),
              HasSubstr("pair.0.sigma_nm: has no effect, it counts only without table"));
  EXPECT_THAT(said(scene.with("table = \"pair.csv\"", "sigma_nm = 0.3")),
              HasSubstr("missing key \"epsilon_kj_mol\" in [pair.0]"));
  EXPECT_THAT(said(scene.with("table = \"pair.csv\"", "sigma_nm = 0.3, epsilon_kj_mol = 1, shift = true")),
              HasSubstr("shift"));
  EXPECT_THAT(said(scene.with("units = 2", "units = 2, lennard_jones_14 = 0.5")),
              HasSubstr("atoms 0 and 3, three bonds apart, have 0.5 of their force, and pairs of a table"));
  EXPECT_EQ(said(scene.with("units = 2", "units = 2, lennard_jones_14 = 0")), "no error");
  EXPECT_THAT(
      said(scene.with("box_nm = 4", "box_nm = 1.5")
               .with("count = 30", "count = 2")
               .with("cutoff_nm = 1.1, switch_nm = 0.9", "cutoff_nm = 0.7")),
      HasSubstr("tabulated pairs: their tables end at 0.8 nm, over half the box's shortest edge, 0.75 nm"));
}

// What a table begins after is neither known nor guessed: such a start is refused, or pushed apart.
TEST(EnergyTable, OfPairsRefusesAStartBelowIt) {
  const std::string begins_late = pair_table().substr(pair_table().find("0.7000"));
  const std::string placed = SceneText{kMixture}
                                 .with("count = 30", "count = 2, centres_nm = [[1, 1, 1], [1.5, 1, 1]]")
                                 .with("units = 2", "coordinates_nm = [[0, 0, 0], [0, 0.4, 0]]")
                                 .with(", [1, 2, 0.4, 3000]", "")
                                 .text;
  const PairFolder files(begins_late);
  EXPECT_THAT(files.said(placed), HasSubstr("scene.toml: at the start atoms "));
  EXPECT_THAT(files.said(placed), HasSubstr("nearer than their table pair.csv begins, at 0.7 nm"));
  EXPECT_THAT(files.said(placed), HasSubstr("run.soft_start = true pushes atoms apart first"));
  Scene pushed =
      files.read(SceneText{placed}.with("dt_fs", "minimise = true, soft_start = true, dt_fs").text);
  Simulation simulation(std::move(pushed));
  EXPECT_TRUE(std::isfinite(simulation.record().total()));
}

}  // namespace
}  // namespace taut::energy_table_tests
