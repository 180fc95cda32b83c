// What bad molecules and places are told: one line with the file, the line and the key.

#include "scene_text.hpp"

namespace taut::molecule_errors_tests {
namespace {

using testing::AllOf, testing::HasSubstr;

const SceneText kGood{R"([atom.C]
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

std::string said(const std::string& old, const std::string& changed) {
  return complaint(kGood.with(old, changed).text);
}
std::string said_of_rows(const std::string& rows) {
  return said("[[place]]", rows + "\n[[place]]");
}

TEST(MoleculeErrors, Atoms) {
  EXPECT_EQ(complaint(kGood.text), "no error");
  EXPECT_EQ(said("[\"C\"", "[\"D\""),
            "scene.toml:4: molecule.chain.atoms: there is no [atom.D]; did you mean \"C\"?");
  EXPECT_EQ(said("[\"C\"", "[3"),
            "scene.toml:4: molecule.chain.atoms[0]: expected a section, got an integer");
  EXPECT_THAT(said("mass_u = 72", "mass = 72"), HasSubstr("scene.toml:4: missing key \"mass_u\""));
  EXPECT_EQ(said("mass_u = 72", "mass_u = -72"),
            "scene.toml:4: molecule.chain.atoms.1.mass_u: expected at least 0, got -72");
  EXPECT_EQ(said("mass_u = 12", "mass_u = 12\nmas = 1"),
            "scene.toml:3: unknown key \"mas\" in [atom.C]; did you mean \"mass_u\"?");
  EXPECT_THAT(said("\"B\"", "\"B\\n\""),
              HasSubstr("scene.toml:4: molecule.chain.atoms.1.name: expected a name of letters"));
  EXPECT_THAT(said("bonds", "residue = \"ß\"\nbonds"), HasSubstr("residue: expected a name of letters"));
  EXPECT_EQ(said("[0, 1, 0.35]]", "[0, 2, 0.35]]\nunit = 5"),
            "scene.toml:6: unknown key \"unit\" in [molecule.chain]; did you mean \"units\"?");
  EXPECT_EQ(complaint(kGood.text, {"molecule.chian.units=3"}),
            "--set molecule.chian.units=3: there is no [molecule.chian]; did you mean \"chain\"?");
  EXPECT_EQ(said(", sigma_nm = 0.47", ""),
            "scene.toml:4: molecule.chain.atoms.1.epsilon_kj_mol: needs a sigma_nm beside it");
  EXPECT_THAT(said("bonds", "units = 1e9\nbonds"),
              HasSubstr("scene.toml:5: molecule.chain.units: 1000000000 of 2 atoms are more"));
  EXPECT_THAT(said("bonds = [[0, 1, 0.35]]", ""), HasSubstr("molecule.chain.atoms: nothing ties"));
}

TEST(MoleculeErrors, Rows) {
  const auto bond = [](const std::string& row) { return said("[0, 1, 0.35]", row); };
  EXPECT_EQ(bond("[0, 2, 0.35]"), "scene.toml:5: molecule.chain.bonds[0]: there is no atom 2, only 0 to 1");
  EXPECT_EQ(bond("[1, 1, 0.35]"), "scene.toml:5: molecule.chain.bonds[0]: names the same atom twice");
  EXPECT_EQ(bond("[0, 1.5, 0.35]"),
            "scene.toml:5: molecule.chain.bonds[0]: expected atoms' indices, counted from 0");
  EXPECT_EQ(bond("[0, -3, 0.35]"), "scene.toml:5: molecule.chain.bonds[0]: there is no atom -3, only 0 to 1");
  EXPECT_EQ(bond("[1, -1, 0.35]"), "scene.toml:5: molecule.chain.bonds[0]: names the same atom twice");
  EXPECT_EQ(bond("[0, 1, 0]"), "scene.toml:5: molecule.chain.bonds[0]: expected a length above 0");
  EXPECT_EQ(bond("[0, 1]"), "scene.toml:5: molecule.chain.bonds[0]: expected 3 numbers, got 2");
  EXPECT_EQ(bond("[0, 1, 0.35],\n[1, 0, 0.3]"),
            "scene.toml:6: molecule.chain.bonds[1]: repeats bonds[0], the same two atoms");
  EXPECT_EQ(said_of_rows("springs = [[0, 1, 0.3, -1]]"),
            "scene.toml:6: molecule.chain.springs[0]: expected a length and a k of 0 or more");
  EXPECT_EQ(said_of_rows("fene = [[0, 1, 30, 0]]"),
            "scene.toml:6: molecule.chain.fene[0]: expected k, and r0 above 0");
  EXPECT_EQ(said_of_rows("angles = [[0, 1, 2, 120, 1]]"),
            "scene.toml:6: molecule.chain.angles[0]: there is no atom 2, only 0 to 1");
  EXPECT_THAT(said_of_rows("units = 2\nangles = [[0, 1, 2, 200, 1]]"),
              HasSubstr("angles[0]: expected an angle of 0 to 180 degrees, and k of 0 or more"));
  EXPECT_THAT(said_of_rows("units = 2\ntorsions = [[0, 1, 2, 3, 1.5, 0, 1]]"),
              HasSubstr("torsions[0]: expected a periodicity of 1 to 64"));
  EXPECT_THAT(said_of_rows("units = 2\nangles = [[2, 3, 4, 100, 1]]"), HasSubstr("there is no atom 4"));
  EXPECT_THAT(said_of_rows("units = 2\npulls = [[2, 1, 1, 1]]"),
              AllOf(HasSubstr("pulls[0]: expected one of its atoms in the first unit, 0 to 1"),
                    HasSubstr("count from the end of all 4 atoms, -2 in place of 2")));
  EXPECT_EQ(said_of_rows("restraints = [[0, 0, 0, 0, -1]]"),
            "scene.toml:6: molecule.chain.restraints[0]: expected a stiffness of 0 or more");
  EXPECT_THAT(said_of_rows("cmap = [[0, 1, 2, 3, 4]]"),
              HasSubstr("scene.toml:6: molecule.chain.cmap: is read of OpenMM's files alone"));
  EXPECT_EQ(said_of_rows("exclude = \"1-5\""),
            "scene.toml:6: molecule.chain.exclude: there is no \"1-5\"; did you mean \"1-2\"?");
  EXPECT_THAT(said_of_rows("exclude = \"1-4\"\ncoulomb_14 = 0.5"),
              HasSubstr("coulomb_14: has no effect, it counts only where exclude is not \"1-4\""));
  EXPECT_THAT(said_of_rows("ring = true"), HasSubstr("ring: has no effect, it counts only with units"));
  EXPECT_THAT(
      complaint("[molecule.ring]\natoms = [{name = \"B\", mass_u = 1}]\nunits = 2\nring = true\n"
                "bonds = [[0, 1, 1]]\nangles = [[0, 1, 2, 120, 25]]\n[[place]]\nmolecule = \"ring\"\n"),
      HasSubstr(
          "scene.toml:3: molecule.ring.units: a ring takes three atoms or more, 2 units of one make 2"));
  EXPECT_THAT(said_of_rows("coordinates_nm = [[0, 0, 0]]"),
              HasSubstr("molecule.chain.coordinates_nm: 1 atoms, expected 2"));
  EXPECT_THAT(said_of_rows("coordinates_nm = [[0, 0, 0], [1, 0, 0]]"),
              HasSubstr("molecule.chain.coordinates_nm: atoms 0 and 1 are 1 nm apart, their bond is 0.35"));
  EXPECT_THAT(said_of_rows("file = \"none.pdb\""), HasSubstr("none.pdb: no such file"));
}

// A strut that starts too short, a rope too long, and what can never be.
TEST(MoleculeErrors, StrutsAndRopes) {
  EXPECT_EQ(said_of_rows("at_most = [[0, 1, 0.3]]"),
            "scene.toml:6: molecule.chain.at_most[0]: its atoms are tied by a rigid bond already");
  EXPECT_EQ(said_of_rows("at_least = [[0, 2, 0.3]]"),
            "scene.toml:6: molecule.chain.at_least[0]: there is no atom 2, only 0 to 1");
  EXPECT_EQ(said_of_rows("at_least = [[0, 1, 0]]"),
            "scene.toml:6: molecule.chain.at_least[0]: expected a length above 0");
  const std::string three = kGood.with("0.35]]", "0.35]]\nunits = 2\n@").text;
  const auto with = [&](const std::string& rows) { return complaint(SceneText{three}.with("@", rows).text); };
  EXPECT_EQ(with("springs = [[0, 2, 0.3, 0]]\nat_least = [[0, 2, 0.4]]\nat_most = [[0, 2, 0.3]]"),
            "scene.toml:9: molecule.chain.at_most[0]: shorter than the strut of 0.4 nm there");
  const std::string straight =
      "springs = [[0, 2, 0.4, 0]]\ncoordinates_nm = [[0, 0, 0], [0.35, 0, 0], [0, 0.4, 0], [0.35, 0.4, 0]]\n";
  EXPECT_EQ(with(straight + "at_least = [[0, 2, 0.4]]\nat_most = [[1, 3, 0.4]]"), "no error");
  EXPECT_THAT(with(straight + "at_least = [[0, 2, 0.5]]"),
              HasSubstr("scene.toml:8: molecule.chain.coordinates_nm: atoms 0 and 2 stand 0.4"));
  EXPECT_THAT(with(straight + "at_most = [[0, 2, 0.3]]"), HasSubstr("more than the 0.3 nm of this rope"));
  EXPECT_EQ(with("springs = [[0, 2, 0.3, 100]]\nat_least = [[0, 2, 0.5]]"), "no error");  // a spring pressed
  EXPECT_THAT(with("springs = [[1, 2, 0.3, 100]]\nat_least = [[0, 2, 0.9]]"), HasSubstr("no shape found"));
}

// No three sides of 1, 1 and 3.
TEST(MoleculeErrors, NoShapeHasAllItsBonds) {
  EXPECT_EQ(complaint(R"([molecule.flat]
atoms = [{name = "A", mass_u = 1}, {name = "B", mass_u = 1}, {name = "C", mass_u = 1}]
bonds = [[0, 1, 1], [1, 2, 1], [0, 2, 3]]
[[place]]
molecule = "flat"
count = 1
)"),
            "scene.toml: bond 2 (0-2): lengths 1, 1 and 3 nm close no triangle (0-1-2): it is longer than "
            "the others together");
  EXPECT_EQ(
      complaint(R"([molecule.flat]
atoms = [{name = "A", mass_u = 1}, {name = "B", mass_u = 1}, {name = "C", mass_u = 1}, {name = "D", mass_u = 1}]
bonds = [[0, 1, 1], [1, 2, 1], [0, 2, 1], [0, 3, 0.55], [1, 3, 0.55], [2, 3, 0.55]]
[[place]]
molecule = "flat"
count = 1
)"),
      "scene.toml:1: molecule.flat: no shape found in which all bonds have their lengths, struts and ropes "
      "too, and no atoms overlap; give coordinates_nm or file");
}

TEST(MoleculeErrors, Places) {
  EXPECT_EQ(said("\"chain\"", "\"chian\""),
            "scene.toml:7: place.0.molecule: there is no \"chian\"; did you mean \"chain\"?");
  EXPECT_EQ(said("count = 3", ""), "scene.toml:6: missing key \"count\" in [place.0]");
  EXPECT_EQ(said("count = 3", "count = 0"), "scene.toml:8: place.0.count: expected at least 1, got 0");
  EXPECT_EQ(said("count = 3", "count = 6e6"),
            "scene.toml:6: place.0: makes it 1.2e+07 atoms, more than the 10000000 taut takes");
  EXPECT_THAT(said("count = 3", "count = 1e300"), HasSubstr("scene.toml:8: place.0.count: out of range"));
  EXPECT_THAT(said("count = 3", "count = 9e18"), HasSubstr("place.0: makes it 1.8e+19 atoms"));
  EXPECT_EQ(said("count = 3", "count = 3\nwithin_nm = [0, 0, 0, 1, 1]"),
            "scene.toml:9: place.0.within_nm: expected six numbers, the lower and the upper corner");
  EXPECT_EQ(said("count = 3", "count = 3\nwithin_nm = [0, 0, 2, 1, 1, 1]"),
            "scene.toml:9: place.0.within_nm: the upper corner is below the lower");
  EXPECT_EQ(said("count = 3", "count = 3\nwithin_nm = [0, 2, 1, 0, 2, 1]"),
            "scene.toml:9: place.0.within_nm: both corners are one point; say centres_nm for that");
  EXPECT_EQ(said("count = 3", "count = 3\nwithin_nm = [0, 0, 2, 5, 5, 2]"), "no error");
  EXPECT_EQ(said("\"chain\"\ncount = 3", "\"tip3p\"\nwithin_nm = [0, 0, 0, 1, 1, 1]"),
            "scene.toml:8: place.0.within_nm: water without a count fills what room there is");
  EXPECT_THAT(said("[[place]]", "[place]"), HasSubstr("scene.toml:6: place: expected a list of"));
  EXPECT_EQ(said("box_nm = 5", "box_nm = 5\nmolecules = 3"),
            "scene.toml:11: build.molecules: copies are counted where they are placed: place.0.count");
  EXPECT_EQ(said("count = 3", "count = 3\ncoutn = 4"),
            "scene.toml:9: unknown key \"coutn\" in [place.0]; did you mean \"count\"?");
  EXPECT_EQ(said("box_nm = 5", "box_nm = 0.7\n[molecule.idle]\natoms = [\"C\"]"),
            "scene.toml:11: molecule.idle: no [[place]] has it");
  EXPECT_EQ(said("box_nm = 5", "kind = \"chains\""),
            "scene.toml:6: place: has no effect, it counts only with build.kind = \"molecules\"");
  EXPECT_EQ(said("box_nm = 5", "kind = \"molecules\"\nbox_nm = 5"), "no error");
  EXPECT_THAT(said("[build]", "[[place]]\nmolecule = \"spce\"\n[build]\nstart = \"none\""),
              HasSubstr("none"));
}

// Said before long: three balls of 0.94 nm do not go into a cube of 1.
TEST(MoleculeErrors, WhatDoesNotFitIsSaid) {
  EXPECT_THAT(complaint(kGood.with("box_nm = 5", "box_nm = 1").with("0.47", "0.94").with("1.1", "0.5").text),
              HasSubstr("scene.toml:6: place.0: there is no room for copy 3 of 3 of \"chain\""));
}

TEST(MoleculeErrors, Boxes) {
  const auto box = [](const std::string& keys) { return said("box_nm = 5", keys); };
  EXPECT_EQ(box("box_nm = -5"), "scene.toml:10: build.box_nm: expected more than 0");
  EXPECT_THAT(box("box_nm = [5, 5]"), HasSubstr("expected 3 numbers, its edges, or 9, its vectors; got 2"));
  EXPECT_EQ(box("box_nm = 5\ndensity_g_cm3 = 1"),
            "scene.toml:11: build.density_g_cm3: has no effect, it counts only without build.box_nm");
  EXPECT_THAT(box("box_nm = [5, 5, 5]\nbox = \"octahedron\""),
              HasSubstr("scene.toml:11: build.box: has no effect, it counts only with a"));
  EXPECT_EQ(box("density_per_nm3 = 0.1"), "no error");
  EXPECT_EQ(box("[[place]]\nmolecule = \"tip3p\""),
            "scene.toml:10: place.1: water without a count fills a box: say build.box_nm, or a count");
  EXPECT_THAT(box("box_nm = 1000\n[[place]]\nmolecule = \"tip3p\""), HasSubstr("more than taut takes"));
}

}  // namespace
}  // namespace taut::molecule_errors_tests
