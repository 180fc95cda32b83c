// LAMMPS data files, in and out, and the energy that LAMMPS finds for them.

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "forcefield/force_field.hpp"
#include "md/units.hpp"
#include "named_scene.hpp"
#include "scene_text.hpp"
#include "systems/lammps/write_data.hpp"

namespace taut::lammps_data_tests {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

Energies energies(const Scene& scene) {
  State s = scene.start;
  s.f = Vectors::Zero(3, s.x.cols());
  ForceField forces(scene.system, s.box, scene.terms);
  ForceField::Evaluation besides;
  forces.evaluate(scene.system, s, besides);
  return forces.energies(s, besides);
}

double total(const Energies& all) {
  double sum = 0;
  for (const auto& [term, energy] : all) sum += energy;
  return sum;
}

struct Folder {
  TemporaryFolder folder;

  Scene read_back(const std::string& keys, const std::string& forcefield = "") const {
    const auto file =
        folder.write("back.toml", "[build]\nkind = \"lammps\"\ndata = \"a.data\"\nunits = \"lj\"\n" + keys +
                                      "\n[forcefield]\n" + forcefield);
    return read_scene(file);
  }
  // What LAMMPS prints of the input without rigid bonds and bath: the potential energy, in kJ/mol, and the length of the vector
  // of all forces, in kJ/mol/nm.
  struct OfLammps {
    double energy, forces;
  };
  OfLammps of_lammps() const {
    std::ifstream in(folder.path() / "a.in");
    std::string text, line;
    while (std::getline(in, line))
      if (!line.starts_with("fix hold") && !line.starts_with("fix bath") && !line.starts_with("#"))
        text += line + "\n";
    folder.write(
        "run.in",
        text + "thermo_style custom step pe fnorm\nthermo_modify norm no format float %.15g\nrun 0\n");
    const std::string shell = fmt::format(
        "cd {} && OMP_NUM_THREADS=1 lmp -in run.in -log none > out.txt 2>&1", folder.path().string());
    EXPECT_EQ(std::system(shell.c_str()), 0);
    std::ifstream out(folder.path() / "out.txt");
    const auto is_head = [](const std::string& row) {  // later versions have more spaces in it
      std::string first, second;
      std::istringstream(row) >> first >> second;
      return first == "Step" && second == "PotEng";
    };
    while (std::getline(out, line))
      if (is_head(line) && std::getline(out, line)) {
        std::istringstream row(line);
        double step = 0;
        OfLammps of{};
        row >> step >> of.energy >> of.forces;
        return of;
      }
    ADD_FAILURE() << "no energy of LAMMPS's";
    return {};
  }
};

const std::string kMixture = R"([atom.A]
mass_u = 12
sigma_nm = 0.34
epsilon_kj_mol = 1
[atom.B]
mass_u = 16
sigma_nm = 0.30
epsilon_kj_mol = 0.5
[molecule.m]
atoms = ["A", "B", "A", "B", "A"]
bonds = [[0, 1, 0.15], [1, 2, 0.15]]
springs = [[2, 3, 0.16, 20000], [3, 4, 0.15, 30000]]
angles = [[0, 1, 2, 110, 300], [1, 2, 3, 115, 200], [2, 3, 4, 100, 150]]
cosine_angles = [[1, 2, 3, 30]]
cosine_squared_angles = [[0, 1, 2, 70, 40]]
torsions = [[0, 1, 2, 3, 3, 180, 2.5], [1, 2, 3, 4, 2, 60, 1.5]]
rb_torsions = [[0, 1, 2, 3, 1, -2, 3, -4, 5, 0]]
lennard_jones_14 = 0.5
[[place]]
molecule = "m"
count = 20
[build]
box_nm = 2.6
[forcefield]
cutoff_nm = 1.1
)";

// The round trip keeps atoms, velocities, bonds and energies. Two styles of a kind are hybrid, which taut does not
// read: here one kind of angles stays.
void expect_back(const std::string& kept) {
  SceneText text = SceneText{kMixture}.with("rb_torsions", "# rb_torsions");
  for (const char* angles : {"angles = [[0", "cosine_angles", "cosine_squared_angles"})
    if (angles != kept) text = text.with(angles, std::string("# ") + angles);
  const Scene plain = read(text.text, {"run.temperature_k=300"});
  const Folder folder;
  write_lammps(plain, folder.folder.path() / "a");
  const Scene back = folder.read_back("rigid_bonds = [1]\nspecial_lj = [0, 0, 0.5]\nmix = \"arithmetic\"",
                                      "cutoff_nm = 1.1");
  ASSERT_EQ(back.system.atoms(), 100);
  EXPECT_LT((back.start.v - plain.start.v).norm(), 1e-14);
  EXPECT_EQ(back.system.bond_count(), 40);
  EXPECT_EQ((back.system.mass - plain.system.mass).norm(), 0);
  const Energies here = energies(plain), there = energies(back);
  ASSERT_EQ(here.size(), there.size());
  for (std::size_t k = 0; k < here.size(); ++k) {
    EXPECT_EQ(here[k].first, there[k].first);
    EXPECT_NEAR(here[k].second, there[k].second, 1e-10 * std::abs(here[k].second) + 1e-20);
  }
}

TEST(LammpsData, GoesOutAndBack) {
  for (const char* kept : {"angles = [[0", "cosine_angles", "cosine_squared_angles"}) expect_back(kept);
  const Scene scene = read(kMixture, {"run.temperature_k=300"});
  const Folder folder;
  write_lammps(scene, folder.folder.path() / "a");
  if (std::system("lmp -h > /dev/null 2>&1") != 0) return;
  // exceptions have no cutoff in taut, and none of these pairs is beyond LAMMPS's
  const double of_lammps = folder.of_lammps().energy;
  EXPECT_NEAR(of_lammps, total(energies(scene)), 1e-9 * std::abs(of_lammps));
}

// LAMMPS puts splines of its own through the rows of tables, of bonds, angles and pairs, beside rigid bonds and
// Lennard-Jones.
TEST(LammpsData, TablesGoOut) {
  const Scene scene = scene_of("coarse_grained");
  const LammpsFiles files = lammps_files(scene, "a.data");
  for (const char* said :
       {"bond_style hybrid harmonic table spline 20000\n", "angle_style table spline 20000\n",
        "pair_style hybrid lj/cut 1.2 table spline 20000\n"})
    EXPECT_THAT(files.input, HasSubstr(said));
  for (const char* said : {"table a.table BOND1\n", "1 a.table ANGLE2\n", "1 1 table a.table PAIR3 1.2\n"})
    EXPECT_THAT(files.data, HasSubstr(said));
  EXPECT_THAT(files.tables, testing::StartsWith("# coarse_grained.bond.csv\nBOND1\nN 1501 FP 0 0 EQ 0.36"));
  if (std::system("lmp -h > /dev/null 2>&1") != 0) return;
  const Folder folder;
  write_lammps(scene, folder.folder.path() / "a");
  const double here = total(energies(scene));
  const auto [energy, forces] = folder.of_lammps();
  EXPECT_NEAR(energy, here, 1e-7 * std::abs(here));
  State s = scene.start;
  ForceField(scene.system, s.box, scene.terms).evaluate(scene.system, s);
  EXPECT_NEAR(forces, s.f.norm(), 1e-6 * s.f.norm());
}

TEST(LammpsData, AMeltWithFeneGoesOutAndBack) {
  const Scene melt =
      scene_of("melt", {"build.bonds=\"fene\"", "build.chains=10", "build.beads=20", "run.steps=0"});
  const Folder folder;
  write_lammps(melt, folder.folder.path() / "a");
  if (std::system("lmp -h > /dev/null 2>&1") == 0) {
    EXPECT_NEAR(folder.of_lammps().energy, total(energies(melt)), 1e-9 * std::abs(total(energies(melt))));
  }
  const Scene back = folder.read_back("special_lj = [0, 1, 1]", "pair = \"wca\"");
  EXPECT_NEAR(total(energies(back)), total(energies(melt)), 1e-10 * std::abs(total(energies(melt))));
}

const SceneText kData{R"(a title

4 atoms
2 atom types
3 bonds
1 bond types
1 angles
1 angle types

-1 9 xlo xhi
0 10 ylo yhi
0 10 zlo zhi

Masses

1 12.0
2 16.0

Pair Coeffs # lj/cut

1 0.1 3.0
2 0.2 4.0

Bond Coeffs # harmonic

1 300 1.5

Angle Coeffs # harmonic

1 50 109.5

Atoms # full

1 1 1 0.5 0 1 1 0 0 0
2 1 2 -0.5 1.5 1 1 0 0 0
3 1 1 0 1.5 2.5 1 0 0 0
4 1 1 0 -0.5 9 1 0 -1 0

Velocities

1 0 0 0
2 0.01 0 0
3 0 0 0
4 0 0 0

Bonds

1 1 1 2
2 1 2 3
3 1 1 4

Angles

1 1 1 2 3
)"};

const std::string kKeys = "[build]\nkind = \"lammps\"\ndata = \"a.data\"\nunits = \"real\"\n";

Scene read_data(const std::string& data, const std::string& more = "[forcefield]\ncutoff_nm = 0.4\n") {
  const TemporaryFolder folder;
  folder.write("a.data", data);
  return read_scene(folder.write("scene.toml", kKeys + more));
}

TEST(LammpsData, RealUnitsAreAngstromKcalAndFemtoseconds) {
  const Scene scene = read_data(kData.text);
  EXPECT_DOUBLE_EQ(scene.start.box.edge.x(), 1.0);
  EXPECT_LT((scene.start.x.col(1) - Vec3(0.25, 0.1, 0.1)).norm(), 1e-15);   // xlo is the origin
  EXPECT_LT((scene.start.x.col(3) - Vec3(0.05, -0.1, 0.1)).norm(), 1e-15);  // by its image flag
  EXPECT_DOUBLE_EQ(scene.start.v(0, 1), 1.0);
  EXPECT_DOUBLE_EQ(scene.terms.bonds[0].k, 2 * 300 * 4.184 * 100);  // K(r − r₀)² has no half
  EXPECT_DOUBLE_EQ(scene.terms.bonds[0].length, 0.15);
  EXPECT_DOUBLE_EQ(scene.terms.angles[0].stiffness, 2 * 50 * 4.184);
  EXPECT_DOUBLE_EQ(scene.terms.nonbonded->charge[0], 0.5);
  ASSERT_TRUE(scene.terms.nonbonded->lj_table);  // geometric mixing
  const LennardJonesTable& table = *scene.terms.nonbonded->lj_table;
  EXPECT_NEAR(table.b(0, 1), 4 * std::sqrt(0.1 * 0.2) * 4.184 * std::pow(std::sqrt(0.3 * 0.4), 6), 1e-15);
  EXPECT_EQ(scene.terms.nonbonded->exceptions.size(), 6u);  // all pairs, 1-4 too
  const Scene rigid =
      read_data(kData.text, "rigid_bonds = [1]\nrigid_angles = [1]\n[forcefield]\ncutoff_nm = 0.4\n");
  EXPECT_EQ(rigid.system.bond_count(), 4);
  EXPECT_NEAR(rigid.system.bonds[3].length, 2 * 0.15 * std::sin(109.5 * M_PI / 360), 1e-15);
}

std::string said(const std::string& old, const std::string& changed, const std::string& more = "") {
  return error_message([&] {
    read_data(old.empty() ? kData.text : kData.with(old, changed).text,
              more + "[forcefield]\ncutoff_nm = 0.4\n");
  });
}

TEST(LammpsData, WhatTautLacksIsRefusedByName) {
  EXPECT_EQ(said("", ""), "no error");
  EXPECT_THAT(said("Angle Coeffs # harmonic", "Angle Coeffs # cosine/delta"),
              HasSubstr("taut has no angle_style \"cosine/delta\""));
  EXPECT_THAT(said("Bond Coeffs # harmonic", "Bond Coeffs"), HasSubstr("give build.bond_style, one of"));
  EXPECT_THAT(said("Atoms # full", "Atoms # sphere"), HasSubstr("taut has no atom_style \"sphere\""));
  EXPECT_THAT(said("Velocities", "Ellipsoids"), HasSubstr("a.data:39: the section Ellipsoids is none"));
  EXPECT_THAT(said("3 bonds", "2 bonds"), HasSubstr("Bonds has 3 rows, expected 2"));
  EXPECT_THAT(said("2 1 2 3\n", "2 1 2 7\n"), HasSubstr("expected an atom from 1 to 4, got 7"));
  EXPECT_THAT(said("1 300 1.5", "1 300 x"), HasSubstr("expected a length, got \"x\""));
  EXPECT_THAT(said("4 atoms", "4 ellipsoids"), HasSubstr("\"4 ellipsoids\" is no line of the header"));
  EXPECT_THAT(said("", "", "rigid_bonds = [2]\n"),
              HasSubstr("build.rigid_bonds: there is no type 2 among 1"));
  EXPECT_THAT(said("", "", "rigid_angles = [1]\n"),
              HasSubstr("angle type 1 is rigid, but its two bonds are not"));
  EXPECT_THAT(said("", "", "special_lj = [0, 0.5, 1]\n"),
              HasSubstr("special_lj: expected 0 or 1 of pairs 1-2"));
}

// What the input does otherwise than the scene stands in its comments.
TEST(LammpsData, TheInputSaysWhatItLeavesOut) {
  const auto input = [](const std::vector<std::string>& overrides) {
    std::vector<std::string> all = {"build.chains=3", "build.beads=10"};
    all.insert(all.end(), overrides.begin(), overrides.end());
    return lammps_files(scene_of("melt", all), "a.data").input;
  };
  const std::string plain = input({"method.name=feedforward"});
  for (const char* absent : {"method.name", "barostat", "minimise", "momentum", "dump", "csvr", "langevin"})
    EXPECT_THAT(plain, Not(HasSubstr(absent)));
  EXPECT_THAT(input({"method.name=newton"}),
              HasSubstr("# - method.name = \"newton\" holds the bonds in taut"));
  const std::string rescaled =
      input({"run.thermostat=rescaling", "run.thermostat_ps=0.5", "run.barostat=c-rescale",
             "run.minimise=true", "run.remove_momentum_every=7", "run.trajectory_every=10"});
  for (const char* said :
       {"\nfix bath all temp/csvr ", " 0.5 ", "# - velocity rescaling", "# - run.barostat = \"c-rescale\"",
        "# - run.minimise", "# - run.remove_momentum_every is left out: fix momentum 7",
        "# - run.trajectory_every"})
    EXPECT_THAT(rescaled, HasSubstr(said));
  EXPECT_THAT(
      input({"run.thermostat=langevin", "run.friction_per_ps=4"}),
      AllOf(HasSubstr("\nfix bath all langevin "), HasSubstr(" 0.25 "), HasSubstr("# - Langevin dynamics")));
}

TEST(LammpsData, WhatLammpsLacksIsRefusedByName) {
  const auto refused = [](const std::string& name,
                          const std::vector<std::string>& overrides = {}) -> std::string {
    return error_message([&] { lammps_files(scene_of(name, overrides), "a.data"); });
  };
  EXPECT_EQ(refused("decane"), "no error");
  EXPECT_THAT(refused("pendulum"), HasSubstr("atom 0 is an anchor of mass 0"));
  EXPECT_THAT(refused("fold"), HasSubstr("LAMMPS cannot express it"));
  EXPECT_THAT(refused("water"), HasSubstr("a reaction field; take forcefield.coulomb = \"pme\""));
}

}  // namespace
}  // namespace taut::lammps_data_tests
