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
  OfLammps of_lammps(const std::string& further = "") const {
    std::ifstream in(folder.path() / "a.in");
    std::string text, line;
    while (std::getline(in, line))
      if (!line.starts_with("fix hold") && !line.starts_with("fix bath") && !line.starts_with("run") &&
          !line.starts_with("#"))
        text += line + "\n";
    folder.write("run.in",
                 text + further +
                     "thermo_style custom step pe fnorm\nthermo_modify norm no format float %.15g\nrun 0\n");
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

// Energy and, where no anchor bears some, forces are LAMMPS's.
void expect_lammps_agrees(const Scene& scene) {
  if (std::system("lmp -h > /dev/null 2>&1") != 0) return;
  const Folder folder;
  write_lammps(scene, folder.folder.path() / "a");
  const double here = total(energies(scene));
  const auto [energy, forces] = folder.of_lammps();
  EXPECT_NEAR(energy, here, 1e-8 * std::abs(here)) << scene.name;
  State s = scene.start;
  ForceField(scene.system, s.box, scene.terms).evaluate(scene.system, s);
  if (scene.system.anchors() > 0) return;
  EXPECT_NEAR(forces, s.f.norm(), 1e-7 * s.f.norm()) << scene.name;
}

// Between walls, whose slit need not begin where the box does; and with anchors, gravity, walls and impropers without a
// box.
TEST(LammpsData, WhatActsFromOutsideGoesOut) {
  const Scene slit = scene_of("slit");
  expect_lammps_agrees(slit);
  const LammpsFiles files = lammps_files(slit, "a.data");
  EXPECT_THAT(files.data, HasSubstr("-0.29999999999999982 4.2999999999999998 zlo zhi"));
  EXPECT_THAT(files.input, HasSubstr("group before1 type 1\n"));
  EXPECT_THAT(files.input, HasSubstr("fix wall1 before1 wall/lj93 zhi 4 2 0.46999999999999997 "));
  EXPECT_THAT(files.input, HasSubstr(" units box pbc yes\nfix_modify wall1 energy yes\n"));

  const std::string held =
      SceneText{kMixture}
          .with("box_nm = 2.6", "gravity_nm_ps2 = [0.5, 0, -2]")
          .with("lennard_jones_14 = 0.5",
                "lennard_jones_14 = 0.5\nimpropers = [[0, 1, 2, 3, 0, 40], [1, 2, 3, 4, 180, 30]]")
          .with("count = 20", "count = 2\nwithin_nm = [0, 0, 1, 2, 2, 3]")
          .with("[build]",
                "[atom.C]\nmass_u = 0\nsigma_nm = 0.3\nepsilon_kj_mol = 0.4\n"
                "[molecule.floor]\natoms = [\"C\"]\n[[place]]\nmolecule = "
                "\"floor\"\ncount = 3\nwithin_nm = [0, 0, 0.2, 2, 2, 0.6]\n[[wall]]\naxis = "
                "\"z\"\nabove_nm = 0\nsigma_nm = 0.3\nepsilon_kj_mol = 3\natoms = [\"B\"]\n[build]")
          .text;
  const Scene scene = read(held, {"run.temperature_k=300"});
  EXPECT_EQ(scene.system.anchors(), 3);
  EXPECT_EQ(scene.terms.harmonic_torsions.size(), 4u);
  expect_lammps_agrees(scene);
  const std::string input = lammps_files(scene, "a.data").input;
  for (const char* said : {"group anchors type 3\ngroup moving subtract all anchors\n",
                           "fix integrate moving nve\n", "fix gravity moving gravity 2.061552812808830",
                           "group before0 type 2\n", " fixed anchors\n", "improper_style harmonic\n",
                           "fix wall0 before0 wall/lj93 zlo 0 3 0.29999999999999999 1000000 units box\n"})
    EXPECT_THAT(input, HasSubstr(said));
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

// Water of four sites is pair_style tip4p's, without atoms M. On a fine mesh energies agree.
TEST(LammpsData, WaterOfFourSitesGoesOut) {
  const Scene water =
      scene_of("water", {"build.model=tip4pew", "forcefield.coulomb=pme", "forcefield.cutoff_nm=0.9",
                         "forcefield.ewald_tolerance=1e-9", "forcefield.dispersion_correction=false"});
  const LammpsFiles files = lammps_files(water, "a.data");
  EXPECT_THAT(files.data, HasSubstr("648 atoms\n2 atom types\n648 bonds\n2 bond types\n216 angles\n"));
  EXPECT_THAT(files.input, HasSubstr("pair_style lj/cut/tip4p/long 1 2 1 1 0.0125000"));
  EXPECT_THAT(files.input, HasSubstr("kspace_style pppm/tip4p 0.1389\n"));
  if (std::system("lmp -h > /dev/null 2>&1") != 0) return;
  const Folder folder;
  write_lammps(water, folder.folder.path() / "a");
  const double here = total(energies(water));
  EXPECT_NEAR(
      folder.of_lammps("pair_modify table 0\nkspace_modify gewald 4.2 mesh 60 60 60 order 7\n").energy, here,
      5e-6 * std::abs(here));
}

// |φ| has one minimum at 0 and 180 degrees alone.
TEST(LammpsData, ImpropersOfStyleHarmonicAreSprings) {
  const auto with = [](const std::string& angle) {
    return kData.with("1 angle types\n", "1 angle types\n1 impropers\n1 improper types\n")
               .with("Angle Coeffs", "Improper Coeffs # harmonic\n\n1 40 " + angle + "\n\nAngle Coeffs")
               .text +
           "\nImpropers\n\n1 1 4 1 2 3\n";
  };
  const Scene scene = read_data(with("180"));
  ASSERT_EQ(scene.terms.harmonic_torsions.size(), 1u);
  EXPECT_DOUBLE_EQ(scene.terms.harmonic_torsions[0].stiffness, 2 * 40 * 4.184);
  EXPECT_DOUBLE_EQ(scene.terms.harmonic_torsions[0].angle, M_PI);
  EXPECT_EQ(scene.terms.harmonic_torsions[0].i, 3);
  EXPECT_THAT(error_message([&] { read_data(with("35")); }),
              HasSubstr("an improper of 35 degrees, whose energy"));
  const SceneText skewed =
      SceneText{kMixture}.with("[[place]]", "impropers = [[0, 1, 2, 3, 35, 40]]\n[[place]]");
  EXPECT_THAT(error_message([&] { lammps_files(read(skewed.text), "a"); }),
              HasSubstr("a harmonic torsion of 35 degrees, neither 0 nor 180"));
}

// Every row has the columns of its style, and each type and each atom one row.
TEST(LammpsData, NoColumnIsPassedOver) {
  EXPECT_THAT(said("1 12.0\n2 16.0", "1 12.0\n1 16.0"),
              HasSubstr("a.data:17: a second row of Masses for atom type 1, the first is in line 16"));
  EXPECT_THAT(said("2 16.0", "2 0"), HasSubstr("a.data:17: a mass of 0, expected more than 0"));
  EXPECT_THAT(said("2 16.0", "2 16.0 7"),
              HasSubstr("a row of Masses has 3 columns, expected 2, the last of them mass"));
  EXPECT_THAT(
      said("1 1 1 0.5 0 1 1 0 0 0", "1 1 1 0.5 0 1 1 0 0 0 0"),
      HasSubstr("a row of Atoms has 11 columns, expected 7 to 10, the last of them molecule type q x"));
  EXPECT_THAT(said("0 1 1 0 0 0", "0 1 1 0 0 0.5"), HasSubstr("an image flag of 0.5"));
  EXPECT_THAT(said("2 0.01 0 0\n", "2 0.01 0 0 0\n"), HasSubstr("a row of Velocities has 5 columns"));
  EXPECT_THAT(said("2 0.01 0 0\n", "1 0.01 0 0\n"), HasSubstr("a second row of Velocities for atom 1"));
  EXPECT_THAT(said("1 300 1.5\n", "1 300 1.5 2\n"),
              HasSubstr("a row of Bond Coeffs has 4 columns, expected 3, the last of them K r0"));
  EXPECT_THAT(said("3 1 1 4\n", "3 1 1 4 2\n"), HasSubstr("a row of Bonds has 5 columns, expected 4"));
  EXPECT_THAT(said("1 1 1 2 3\n", "1 1 1 2 3 4\n"), HasSubstr("a row of Angles has 6 columns, expected 5"));
  EXPECT_THAT(said("1 0.1 3.0\n2 0.2", "1 0.1 3.0\n1 0.2"), HasSubstr("a second row of Pair Coeffs"));
  EXPECT_THAT(said("# lj/cut", "# lj/cut/tip4p/long"), HasSubstr("taut has no pair_style"));
}

// A cutoff of a row is that of all pairs, or there is an error; without forcefield.cutoff_nm it counts.
TEST(LammpsData, CutoffsOfPairsAreNotPassedOver) {
  EXPECT_EQ(said("1 0.1 3.0\n", "1 0.1 3.0 4.0\n"), "no error");  // Å
  EXPECT_THAT(
      said("1 0.1 3.0\n", "1 0.1 3.0 3.36739\n"),
      HasSubstr("a.data:21: a pair cut off at 0.336739 nm, expected 0.4 nm, forcefield.cutoff_nm: taut "
                "has one"));
  EXPECT_EQ(said("1 0.1 3.0\n", "1 0 3.0 2.0\n"), "no error");  // no force
  const SceneText both = kData.with(
      "Pair Coeffs # lj/cut\n\n1 0.1 3.0\n2 0.2 4.0",
      "PairIJ Coeffs # lj/cut/coul/cut\n\n1 1 0.1 3.0 3.5 3.5\n1 2 0.1 3.5 3.5 3.5\n2 2 0.2 4.0 3.5 3.5");
  EXPECT_DOUBLE_EQ(*read_data(both.text, "").terms.nonbonded->cutoff, 0.35);
  const auto complaint = [&](const std::string& old, const std::string& changed) {
    return error_message([&] { read_data(both.with(old, changed).text, ""); });
  };
  EXPECT_THAT(complaint("3.5 3.5\n2 2", "2.5 3.5\n2 2"),
              HasSubstr("cut off at 0.25 nm, expected 0.35 nm, as"));
  EXPECT_THAT(complaint("3.5 3.5\n2 2", "3.5 2.5\n2 2"),
              HasSubstr("cut off at 0.25 nm, expected 0.35 nm, as"));
  EXPECT_THAT(complaint("1 2 0.1 3.5", "1 1 0.1 3.5"),
              HasSubstr("a second row of PairIJ Coeffs for types 1"));
  EXPECT_THAT(complaint("1 2 0.1 3.5 3.5 3.5\n", ""), HasSubstr("PairIJ Coeffs has 2 rows, expected 3"));
  EXPECT_THAT(complaint("1 2 0.1 3.5", "1 2 0.1 3.5 9"), HasSubstr("has 7 columns, expected 4 to 6"));
}

// Repulsive beads end at their minimum.
TEST(LammpsData, CutoffsOfRepulsiveBeadsAreAtTheirMinimum) {
  const auto complaint = [](const std::string& cutoff, const std::string& sigma = "3.0") {
    const SceneText beads = kData.with("1 0.1 3.0\n2 0.2 4.0", "1 0.1 3.0 " + cutoff + "\n2 0.1 " + sigma)
                                .with("1 1 1 0.5", "1 1 1 0")
                                .with("2 1 2 -0.5", "2 1 2 0");
    return error_message([&] { read_data(beads.text, "[forcefield]\npair = \"wca\"\n"); });
  };
  EXPECT_EQ(complaint("3.36739"), "no error");
  EXPECT_THAT(complaint("4"),
              HasSubstr("a pair cut off at 0.4 nm, expected 0.336739 nm, where pair = \"wca\""));
  EXPECT_THAT(complaint("3.36739", "4.0"), HasSubstr("wca takes one"));
}

TEST(LammpsData, ChargesBesideAPairStyleWithoutThemAreNoted) {
  EXPECT_THAT(read_data(kData.text).notes,
              testing::Contains(HasSubstr("its charges act, which LAMMPS's pair_style lj/cut leaves out")));
  EXPECT_THAT(read_data(kData.with("# lj/cut", "# lj/cut/coul/long").text).notes,
              testing::Each(Not(HasSubstr("charges act"))));
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
  EXPECT_THAT(input({"run.thermostat=langevin", "run.friction_per_ps=0"}),
              AllOf(Not(HasSubstr("fix bath")), HasSubstr("# - run.friction_per_ps = 0 leaves")));
  EXPECT_THAT(
      input({"run.thermostat=langevin", "run.friction_per_ps=4"}),
      AllOf(HasSubstr("\nfix bath all langevin "), HasSubstr(" 0.25 "), HasSubstr("# - Langevin dynamics")));
}

// fix shake stops on chains: "Shake clusters are connected".
TEST(LammpsData, TheInputOffersFixShakeWhereItHoldsTheBonds) {
  const auto input = [](const std::string& bonds) {
    return lammps_files(read(fmt::format(R"(
[build]
kind = "atoms"
atoms = [[0, 0, 0, 1], [1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 1], [-1, 0, 0, 1]]
bonds = [{}]
)",
                                         bonds)),
                        "a.data")
        .input;
  };
  const char* may = "fix shake or rattle may stand in its place";
  EXPECT_THAT(input("[0, 1, 1]"), HasSubstr(may));
  EXPECT_THAT(input("[0, 1, 1], [0, 2, 1], [0, 3, 1]"), HasSubstr(may));
  for (const char* bonds :
       {"[0, 1, 1], [0, 2, 1], [0, 3, 1], [0, 4, 1]", "[1, 0, 1], [0, 2, 1], [2, 3, 1.4142135623730951]",
        "[0, 1, 1], [0, 2, 1], [1, 2, 1.4142135623730951]"})
    EXPECT_THAT(input(bonds), AllOf(HasSubstr("cannot stand in its place"), Not(HasSubstr(may)))) << bonds;
}

TEST(LammpsData, WhatLammpsLacksIsRefusedByName) {
  const auto refused = [](const std::string& name,
                          const std::vector<std::string>& overrides = {}) -> std::string {
    return error_message([&] { lammps_files(scene_of(name, overrides), "a.data"); });
  };
  EXPECT_EQ(refused("decane"), "no error");
  EXPECT_EQ(refused("pendulum"), "no error");
  const std::vector<std::string> pme = {"forcefield.coulomb=pme"};
  EXPECT_EQ(refused("water", {"build.model=tip4pew", pme[0]}), "no error");
  EXPECT_THAT(refused("water", {"build.model=tip5p", pme[0]}),
              HasSubstr("atom 3 is a virtual site, and LAMMPS has"));
  EXPECT_THAT(refused("fold"), HasSubstr("LAMMPS cannot express it"));
  EXPECT_THAT(refused("water"), HasSubstr(": a reaction field; take forcefield.coulomb = \"pme\""));
  EXPECT_THAT(refused("chain"), HasSubstr(": a switch of Lennard-Jones; leave forcefield.switch_nm out"));
}

}  // namespace
}  // namespace taut::lammps_data_tests
