// LAMMPS data files in.

#include "lammps_files.hpp"
#include "md/units.hpp"

namespace taut::lammps_data_tests {
namespace {

using testing::HasSubstr;
using testing::Not;
using tests::kMixture;

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
  EXPECT_THAT(said("", "", "rigid_bonds = [2]\n"), HasSubstr("build.rigid_bonds: there is no type 2 among"));
  EXPECT_THAT(said("", "", "rigid_angles = [1]\n"), HasSubstr("angle type 1 is rigid, but its two bonds"));
  EXPECT_THAT(said("", "", "special_lj = [0, 0.5, 1]\n"), HasSubstr("special_lj: expected 0 or 1 of pairs"));
}

// Every row has the columns of its style, and each type and each atom one row.
TEST(LammpsData, NoColumnIsPassedOver) {
  EXPECT_THAT(said("1 12.0\n2 16.0", "1 12.0\n1 16.0"), HasSubstr("a.data:17: a second row of Masses for"));
  EXPECT_THAT(said("2 16.0", "2 0"), HasSubstr("a.data:17: a mass of 0, expected more than 0"));
  EXPECT_THAT(said("2 16.0", "2 16.0 7"), HasSubstr("a row of Masses has 3 columns, expected 2, the last"));
  EXPECT_THAT(said("1 1 1 0.5 0 1 1 0 0 0", "1 1 1 0.5 0 1 1 0 0 0 0"), HasSubstr("a row of Atoms has 11"));
  EXPECT_THAT(said("0 1 1 0 0 0", "0 1 1 0 0 0.5"), HasSubstr("an image flag of 0.5"));
  EXPECT_THAT(said("2 0.01 0 0\n", "2 0.01 0 0 0\n"), HasSubstr("a row of Velocities has 5 columns"));
  EXPECT_THAT(said("2 0.01 0 0\n", "1 0.01 0 0\n"), HasSubstr("a second row of Velocities for atom 1"));
  EXPECT_THAT(said("1 300 1.5\n", "1 300 1.5 2\n"), HasSubstr("a row of Bond Coeffs has 4 columns"));
  EXPECT_THAT(said("3 1 1 4\n", "3 1 1 4 2\n"), HasSubstr("a row of Bonds has 5 columns, expected 4"));
  EXPECT_THAT(said("1 1 1 2 3\n", "1 1 1 2 3 4\n"), HasSubstr("a row of Angles has 6 columns, expected 5"));
  EXPECT_THAT(said("1 0.1 3.0\n2 0.2", "1 0.1 3.0\n1 0.2"), HasSubstr("a second row of Pair Coeffs"));
  EXPECT_THAT(said("# lj/cut", "# lj/cut/tip4p/long"), HasSubstr("taut has no pair_style"));
}

// A cutoff of a row is that of all pairs, or there is an error; without forcefield.cutoff_nm it counts.
TEST(LammpsData, CutoffsOfPairsAreNotPassedOver) {
  EXPECT_EQ(said("1 0.1 3.0\n", "1 0.1 3.0 4.0\n"), "no error");  // Å
  EXPECT_THAT(said("1 0.1 3.0\n", "1 0.1 3.0 3.36739\n"), HasSubstr("a.data:21: a pair cut off at 0.336739"));
  EXPECT_EQ(said("1 0.1 3.0\n", "1 0 3.0 2.0\n"), "no error");  // no force
  const SceneText both = kData.with(
      "Pair Coeffs # lj/cut\n\n1 0.1 3.0\n2 0.2 4.0",
      "PairIJ Coeffs # lj/cut/coul/cut\n\n1 1 0.1 3.0 3.5 3.5\n1 2 0.1 3.5 3.5 3.5\n2 2 0.2 4.0 3.5 3.5");
  EXPECT_DOUBLE_EQ(*read_data(both.text, "").terms.nonbonded->cutoff, 0.35);
  const auto complaint = [&](const std::string& old, const std::string& changed) {
    return error_message([&] { read_data(both.with(old, changed).text, ""); });
  };
  EXPECT_THAT(complaint("3.5 3.5\n2 2", "2.5 3.5\n2 2"), HasSubstr("cut off at 0.25 nm, expected 0.35 nm"));
  EXPECT_THAT(complaint("3.5 3.5\n2 2", "3.5 2.5\n2 2"), HasSubstr("cut off at 0.25 nm, expected 0.35 nm"));
  EXPECT_THAT(complaint("1 2 0.1 3.5", "1 1 0.1 3.5"), HasSubstr("a second row of PairIJ Coeffs for types"));
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
  EXPECT_THAT(complaint("4"), HasSubstr("a pair cut off at 0.4 nm, expected 0.336739 nm, where pair ="));
  EXPECT_THAT(complaint("3.36739", "4.0"), HasSubstr("wca takes one"));
}

TEST(LammpsData, ChargesBesideAPairStyleWithoutThemAreNoted) {
  EXPECT_THAT(read_data(kData.text).notes,
              testing::Contains(HasSubstr("its charges act, which LAMMPS's pair_style lj/cut leaves out")));
  EXPECT_THAT(read_data(kData.with("# lj/cut", "# lj/cut/coul/long").text).notes,
              testing::Each(Not(HasSubstr("charges act"))));
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
  EXPECT_THAT(error_message([&] { read_data(with("35")); }), HasSubstr("an improper of 35 degrees, whose"));
  const SceneText skewed =
      SceneText{kMixture}.with("[[place]]", "impropers = [[0, 1, 2, 3, 35, 40]]\n[[place]]");
  EXPECT_THAT(error_message([&] { lammps_files(read(skewed.text), "a"); }), HasSubstr("a harmonic torsion"));
}

}  // namespace
}  // namespace taut::lammps_data_tests
