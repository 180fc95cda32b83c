// Where the molecules of a scene are placed.

#include "polymer_scene.hpp"
#include "systems/scene/scene_source.hpp"
#include "systems/scene/start_file.hpp"

namespace taut::placements_tests {
namespace {

using testing::HasSubstr;

const std::string kSolution = kPolymers + R"([molecule.Na]
atoms = [{name = "NA", mass_u = 22.99, charge_e = 1, sigma_nm = 0.26, epsilon_kj_mol = 0.4, element = "Na"}]
[[place]]
molecule = "tip3p"
[[place]]
molecule = "Na"
count = 4
)";

// Water fills what is left, about as densely as it is.
TEST(Placements, WaterFillsWhatIsLeft) {
  const Scene scene = read(kSolution);
  const int waters = (scene.system.atoms() - 64) / 3;
  const double alone = 33.0 * (125 - 60 * 0.08);
  EXPECT_GT(waters, 0.9 * alone);
  EXPECT_LT(waters, alone);
  EXPECT_EQ(scene.system.bond_count(), 57 + 3 * waters);
  EXPECT_GT(nearest(scene), 0.75);
  EXPECT_EQ(scene.names.kinds[scene.names.kind[60]].atom, "OW");
  EXPECT_EQ(scene.names.kinds[scene.names.kind.back()].element, "Na");
  EXPECT_EQ(scene.names.residue.back(), 3 + waters + 3);
  EXPECT_DOUBLE_EQ(scene.terms.nonbonded->charge.sum(), 4);

  const Scene fewer = read(with(kSolution, "\"tip3p\"", "\"tip4pew\"\ncount = 500"));
  EXPECT_EQ(fewer.system.atoms(), 60 + 4 * 500 + 4);
  EXPECT_EQ(fewer.system.sites.size(), 500u);
  EXPECT_THAT(complaint(with(kSolution, "\"tip3p\"", "\"spce\"\ncount = 9000")),
              HasSubstr("place.1: there is room for"));
}

// Elements of a list are named by their numbers.
TEST(Placements, IsOverriddenByItsNumber) {
  EXPECT_EQ(read(kPolymers, {"place.0.count=5"}).system.atoms(), 100);
  const Scene heavy =
      read(kPolymers, {"molecule.polymer.atoms.0.mass_u=9", "molecule.polymer.bonds.0=[0, 1, 0.5]"});
  EXPECT_EQ(heavy.system.mass[0], 9);
  EXPECT_EQ(heavy.system.bonds[3].length, 0.5);
  EXPECT_THAT(complaint(kPolymers, {"place.1.count=5"}), HasSubstr("--set place.1.count=5: there is no"));
  EXPECT_THAT(complaint(kPolymers, {"place.0.count=x"}), HasSubstr("--set place.0.count=x: place.0.count"));
  EXPECT_THAT(complaint(kPolymers, {"build.molecules=5"}), HasSubstr("place.0.count"));
}

TEST(Placements, OnALatticeAboutCentresAndInShapes) {
  const Scene lattice = read(with(kSolution, "\"tip3p\"", "\"Na\"\ncount = 27\narrange = \"lattice\""));
  const Vec3 first = lattice.start.x.col(60), second = lattice.start.x.col(61);
  EXPECT_LT((second - first - Vec3(5 / 3.0, 0, 0)).norm(), 1e-12);
  const Scene centred = read(with(kSolution, "\"tip3p\"", "\"Na\"\ncentres_nm = [[1, 2, 3], [4, 1, 1]]"));
  EXPECT_EQ(centred.start.x.col(61), Vec3(4, 1, 1));
  EXPECT_EQ(centred.system.atoms(), 66);
  const Scene shaped = read(with(kPolymers, "box_nm = 5", "box_nm = 5\nbox = \"dodecahedron\""));
  EXPECT_NEAR(shaped.start.box.volume(), 125 * std::sqrt(0.5), 1e-9);
  EXPECT_GT(nearest(shaped), 0.84);
  EXPECT_FALSE(read(with(with(kPolymers, "box_nm = 5", ""), "cutoff_nm = 1.1", "")).start.box.periodic());
}

// A molecule's shape, and all of a place's atoms, from files; the names go with them.
TEST(Placements, FromFiles) {
  const TemporaryFolder folder;
  const std::string two_molecules =
      "two\n 4\n    1LEU     C1    1   0.100   0.100   0.100\n    1LEU     C2    2   1.950   0.100   0.100\n"
      "    2LEU     C1    3   1.000   1.000   1.000\n    2LEU     C2    4   1.150   1.000   1.000\n"
      "   2.0   2.0   2.0\n";
  folder.write("two.gro", two_molecules);
  const std::string text = R"([molecule.pair]
atoms = [{name = "A", mass_u = 12, element = "C"}, {name = "B", mass_u = 12}]
bonds = [[0, 1, 0.15]]
[[place]]
molecule = "pair"
file = "two.gro"
)";
  const auto file = folder.write("scene.toml", text);
  const Scene scene = read_scene(file);
  EXPECT_EQ(scene.start.box.edge, Vec3::Constant(2));
  EXPECT_LT((scene.start.x.col(1) - Vec3(-0.05, 0.1, 0.1)).norm(), 1e-12);  // whole, from across the box
  EXPECT_EQ(scene.names.kinds[scene.names.kind[2]].atom, "C1");
  EXPECT_EQ(scene.names.kinds[scene.names.kind[2]].residue, "LEU");
  EXPECT_EQ(scene.names.kinds[scene.names.kind[2]].element, "C");
  EXPECT_EQ(scene.names.residue, (std::vector<int>{0, 0, 1, 1}));
  EXPECT_FALSE(scene.positions_drawn);

  EXPECT_TRUE(scene.notes.empty());

  // Made again from what was read, wherever it now is.
  ASSERT_EQ(scene.files.size(), 2u);
  EXPECT_EQ(source_of(scene, {}).read().start.x, scene.start.x);

  // A box that is not reduced is, and the run's notes say so.
  folder.write("two.gro", with(two_molecules, "   2.0   2.0   2.0", " 2 2 2 0 0 -2 0 0 1"));
  const Scene skewed = read_scene(file);
  EXPECT_EQ(skewed.start.box.tilt, Vec3(0, 0, 1));
  ASSERT_EQ(skewed.notes.size(), 1u);
  EXPECT_THAT(skewed.notes[0], HasSubstr("two.gro: its box is reduced to bx = 0, cx = 0, cy = 1 nm (b + a)"));

  const auto said = [&](const std::string& old, const std::string& changed) {
    folder.write("scene.toml", with(text, old, changed));
    return folder.without_path(error_message([&] { read_scene(file); }));
  };
  EXPECT_THAT(said("0.15", "0.9"), HasSubstr("scene.toml:6: place.0.file: atoms 0 and 1 are 0.15 nm apart"));
  EXPECT_EQ(said("\"two.gro\"", "\"two.gro\"\ncount = 3"),
            "scene.toml:7: place.0.count: 3, but 2 copies are given");
  EXPECT_THAT(said("\"two.gro\"", "\"none.gro\""), HasSubstr("scene.toml:6: place.0.file: "));
  EXPECT_THAT(said("\"two.gro\"", "\"none.gro\""), HasSubstr("none.gro: no such file"));
  EXPECT_EQ(said("{name = \"B\", mass_u = 12}]",
                 "{name = \"B\", mass_u = 12}, {name = \"D\", mass_u = 1}]\n"
                 "springs = [[1, 2, 0.1, 5]]"),
            "scene.toml:7: place.0.file: 4 atoms are no whole number of molecules of 3");
}

// The last state of a run is a start, in the box that a barostat has come to.
TEST(Placements, GoesOnInTheBoxOfAStart) {
  State end = read(kPolymers).start;
  const TemporaryFolder folder;
  end.box = end.box.scaled(Vec3::Constant(1.01));
  end.v = Vectors::Random(3, 60);
  write_start(folder.path() / "end.start.toml", end);
  const Scene next = read_scene(folder.write("polymers.toml", kPolymers),
                                {"build.start=" + (folder.path() / "end.start.toml").string()});
  EXPECT_EQ(next.start.x, end.x);
  EXPECT_EQ(next.start.v, end.v);
  EXPECT_EQ(next.start.box, end.box);
}

// A start that heats up is said to.
TEST(Placements, NotesOfTheStart) {
  EXPECT_THAT(read(kPolymers).notes, testing::ElementsAre(HasSubstr("equilibrate")));
  EXPECT_THAT(read(kPolymers, {"run.temperature_k=300", "run.thermostat=langevin"}).notes,
              testing::IsEmpty());
  const std::string dense = with(kPolymers, "count = 3", "count = 60");
  EXPECT_THAT(read(dense).notes, testing::Contains(HasSubstr("run.minimise = true relaxes it")));
  EXPECT_THAT(read(dense, {"run.minimise=true"}).notes, testing::IsEmpty());
  EXPECT_THAT(read(kSolution).notes, testing::Not(testing::Contains(HasSubstr("water cut to fit"))));
}

}  // namespace
}  // namespace taut::placements_tests
