// Molecules that are said in a scene, and where they are placed.

#include <fmt/format.h>

#include <numbers>

#include "forcefield/force_field.hpp"
#include "md/observables.hpp"
#include "md/units.hpp"
#include "named_scene.hpp"
#include "scene_text.hpp"
#include "systems/scene_source.hpp"
#include "systems/start_file.hpp"

namespace taut::molecules_tests {
namespace {

using testing::HasSubstr;

const std::string kPolymers = R"([molecule.polymer]
atoms = [{name = "B", mass_u = 72, sigma_nm = 0.47, epsilon_kj_mol = 3.5}]
units = 20
bonds = [[0, 1, 0.35]]
angles = [[0, 1, 2, 120, 25]]
[[place]]
molecule = "polymer"
count = 3
[build]
box_nm = 5
[forcefield]
cutoff_nm = 1.1
)";

std::string with(const std::string& text, const std::string& old, const std::string& changed) {
  return SceneText{text}.with(old, changed).text;
}

double energy(const Scene& scene, const Vectors& x) {
  State s = scene.start;
  s.x = x;
  s.f = Vectors::Zero(3, x.cols());
  ForceField forces(scene.system, s.box, scene.terms);
  return forces.evaluate_energy(scene.system, s);
}

// Two atoms that no term puts close to each other, and their least distance in σ.
double nearest(const Scene& scene) {
  const Nonbonded& nb = *scene.terms.nonbonded;
  std::set<std::pair<int, int>> near;
  for (const auto& pair : nb.exceptions) near.insert(std::minmax(pair.i, pair.j));
  double least = 1e9;
  for (int a = 0; a < scene.system.atoms(); ++a)
    for (int b = a + 1; b < scene.system.atoms(); ++b) {
      if (near.contains({a, b}) || nb.epsilon[a] == 0 || nb.epsilon[b] == 0) continue;
      const double r = scene.start.box.nearest_image(scene.start.x.col(b) - scene.start.x.col(a)).norm();
      least = std::min(least, 2 * r / (nb.sigma[a] + nb.sigma[b]));
    }
  return least;
}

TEST(Molecules, AreGrownAtTheirLengthsAndAnglesWithoutOverlap) {
  const Scene scene = read(kPolymers);
  ASSERT_EQ(scene.system.atoms(), 60);
  EXPECT_EQ(scene.system.bond_count(), 57);
  EXPECT_EQ(scene.terms.angles.size(), 54u);
  EXPECT_LT(bond_errors(scene.system, scene.start.x).max, 1e-12);
  for (const auto& [i, j, k, angle, stiffness] : scene.terms.angles) {
    const Vec3 a = scene.start.x.col(i) - scene.start.x.col(j),
               b = scene.start.x.col(k) - scene.start.x.col(j);
    EXPECT_NEAR(a.dot(b) / (a.norm() * b.norm()), -0.5, 1e-12);
  }
  EXPECT_GT(nearest(scene), 0.84);
  EXPECT_GT(nearest(read(with(kPolymers, "angles = [[0, 1, 2, 120, 25]]", ""))), 0.84);
  EXPECT_EQ(scene.start.box.edge, Vec3::Constant(5));
  EXPECT_EQ(scene.names.residue[59], 2);
  EXPECT_EQ(scene.names.kinds[scene.names.kind[59]].residue, "poly");
  EXPECT_TRUE(scene.positions_drawn);
  EXPECT_NE(read(kPolymers, {"run.seed=2"}).start.x, scene.start.x);
  EXPECT_EQ(read(kPolymers).start.x, scene.start.x);
}

// Of the directions that there are, one is chosen by the torsion's own weight: ⟨cos φ⟩ = −I₁(1)/I₀(1) at
// U = kT(1 + cos φ), to the standard error of 4000 and what 24 directions leave.
TEST(Molecules, TorsionsAreDrawnByTheirWeight) {
  const Scene scene = read(fmt::format(R"([molecule.four]
atoms = [{{name = "C", mass_u = 12}}]
units = 4
bonds = [[0, 1, 0.15]]
angles = [[0, 1, 2, 110, 100]]
torsions = [[0, 1, 2, 3, 1, 0, {}]]
[[place]]
molecule = "four"
count = 4000
)",
                                       kBoltzmann * 300));
  double sum = 0;
  for (const auto& t : scene.terms.torsions) {
    const auto& x = scene.start.x;
    const Vec3 axis = (x.col(t.k) - x.col(t.j)).normalized();
    const auto across = [&](Vec3 d) { return Vec3(d - d.dot(axis) * axis).normalized(); };
    sum += across(x.col(t.i) - x.col(t.j)).dot(across(x.col(t.l) - x.col(t.k)));
  }
  EXPECT_NEAR(sum / 4000, -0.44639, 0.03);
}

// ⟨cos⟩ from bond to bond is coth κ − 1/κ at U = κkT(1 + cos θ), its square from bond to next but one; 1/κ off 1 for stiff
// chains, and 0 for free ones. Chains that began as free ones would take hundreds of picoseconds to straighten.
TEST(Molecules, CosineAnglesAreDrawnByTheirWeight) {
  for (const double kappa : {0.0, 4.0, 200.0}) {
    const Scene scene = read(fmt::format(R"([molecule.stiff]
atoms = [{{name = "B", mass_u = 72}}]
units = 30
bonds = [[0, 1, 0.4]]
cosine_angles = [[0, 1, 2, {}]]
[[place]]
molecule = "stiff"
count = 200
)",
                                         kappa * kBoltzmann * 300));
    const auto bond = [&](int chain, int k) {
      const auto& x = scene.start.x;
      return Vec3((x.col(30 * chain + k + 1) - x.col(30 * chain + k)) / 0.4);
    };
    double next = 0, next_but_one = 0;
    for (int chain = 0; chain < 200; ++chain)
      for (int k = 0; k + 2 < 29; ++k) {
        next += bond(chain, k).dot(bond(chain, k + 1)) / (200 * 27);
        next_but_one += bond(chain, k).dot(bond(chain, k + 2)) / (200 * 27);
      }
    const double expected = kappa == 0 ? 0 : 1 / std::tanh(kappa) - 1 / kappa;
    EXPECT_NEAR(next, expected, 0.03) << kappa;
    EXPECT_NEAR(next_but_one, expected * expected, 0.04) << kappa;
  }
}

// Struts and ropes count on with the units; what is grown keeps to them, rings too.
TEST(Molecules, AreGrownWithinReachOfStrutsAndRopes) {
  const Scene scene = read(R"([molecule.chain]
atoms = [{name = "B", mass_u = 1}]
units = 8
bonds = [[0, 1, 1]]
at_least = [[0, 2, 1.2]]
at_most = [[0, 3, 2.5], [0, 7, 4.5]]
[molecule.ring]
atoms = [{name = "B", mass_u = 1}]
units = 6
ring = true
bonds = [[0, 1, 1]]
at_least = [[0, 3, 1.5]]
[[place]]
molecule = "chain"
count = 20
[[place]]
molecule = "ring"
count = 20
)");
  const System& sys = scene.system;
  ASSERT_EQ(sys.one_sided.size(), 20u * (6 + 5 + 1 + 3));
  EXPECT_EQ(sys.one_sided[15 - 3].i, 8);  // the second chain's
  for (const auto& bond : sys.one_sided) {
    const double r = (scene.start.x.col(bond.j) - scene.start.x.col(bond.i)).norm();
    EXPECT_GT(static_cast<int>(bond.side) * (r - bond.length), -1e-5);
  }
  EXPECT_LT(bond_errors(sys, scene.start.x).max, 1e-5);
}

// Rings and branched molecules: all lengths, and the angles that fit.
TEST(Molecules, CloseTheirRings) {
  const Scene ring = read(R"([molecule.ring]
atoms = [{name = "B", mass_u = 1, sigma_nm = 0.9, epsilon_kj_mol = 1}]
units = 8
ring = true
bonds = [[0, 1, 1.0]]
[[place]]
molecule = "ring"
count = 5
[molecule.methane]
atoms = [{name = "C", mass_u = 12.011}, {name = "H1", mass_u = 1.008}, {name = "H2", mass_u = 1.008},
  {name = "H3", mass_u = 1.008}, {name = "H4", mass_u = 1.008}]
bonds = [[0, 1, 0.109], [0, 2, 0.109], [0, 3, 0.109], [0, 4, 0.109]]
angles = [[1, 0, 2, 109.4712206, 1], [1, 0, 3, 109.4712206, 1], [1, 0, 4, 109.4712206, 1],
  [2, 0, 3, 109.4712206, 1], [2, 0, 4, 109.4712206, 1], [3, 0, 4, 109.4712206, 1]]
[[place]]
molecule = "methane"
count = 2
)");
  EXPECT_EQ(ring.system.bond_count(), 5 * 8 + 2 * 4);
  EXPECT_LT(bond_errors(ring.system, ring.start.x).max, 1e-9);
  Scene bends = ring;
  bends.terms.nonbonded.reset();
  EXPECT_LT(energy(bends, ring.start.x), 1e-9);
}

TEST(Molecules, PairsNearAlongTheChainAreExcludedOrScaled) {
  const std::string charged = with(kPolymers, "epsilon_kj_mol = 3.5", "epsilon_kj_mol = 3.5, charge_e = 0.5");
  const auto pairs = [&](const std::string& keys) {
    return read(with(charged, "units = 20", "units = 20\n" + keys)).terms.nonbonded->exceptions;
  };
  EXPECT_EQ(pairs("").size(), 3u * (19 + 18));
  EXPECT_EQ(pairs("exclude = \"none\"").size(), 0u);
  EXPECT_EQ(pairs("exclude = \"1-2\"").size(), 3u * 19);
  EXPECT_EQ(pairs("exclude = \"1-4\"").size(), 3u * (19 + 18 + 17));
  const auto scaled = pairs("lennard_jones_14 = 0.5\ncoulomb_14 = 0.8");
  ASSERT_EQ(scaled.size(), 3u * (19 + 18 + 17));
  EXPECT_EQ(scaled[0].epsilon, 0);
  EXPECT_EQ(scaled[2].j, 3);
  EXPECT_DOUBLE_EQ(scaled[2].epsilon, 1.75);
  EXPECT_DOUBLE_EQ(scaled[2].charge_product, 0.8 * 0.25);
  EXPECT_DOUBLE_EQ(scaled[2].sigma, 0.47);
}

// A side group on every bead, repeated with it; a row reaches into the next unit.
TEST(Molecules, UnitsRepeatAtomsAndRows) {
  const Scene scene = read(R"([atom.BB]
mass_u = 2
[atom.SC]
mass_u = 1
[molecule.brush]
atoms = ["BB", "SC"]
units = 3
bonds = [[0, 1, 0.2], [0, 2, 0.3]]
springs = [[1, 3, 0.4, 10]]
impropers = [[1, 0, 2, 3, 180, 5]]
pulls = [[1, 0, 0, 7]]
[[place]]
molecule = "brush"
count = 2
[build]
gravity_nm_ps2 = [0, 0, -1]
)");
  std::vector<std::pair<int, int>> bonds;
  for (const auto& bond : scene.system.bonds) bonds.emplace_back(bond.i, bond.j);
  EXPECT_THAT(bonds, testing::ElementsAre(std::pair(0, 1), std::pair(0, 2), std::pair(2, 3), std::pair(2, 4),
                                          std::pair(4, 5), std::pair(6, 7), std::pair(6, 8), std::pair(8, 9),
                                          std::pair(8, 10), std::pair(10, 11)));
  ASSERT_EQ(scene.terms.bonds.size(), 4u);
  EXPECT_EQ(scene.terms.bonds[3].j, 11);
  ASSERT_EQ(scene.terms.harmonic_torsions.size(), 4u);
  EXPECT_EQ(scene.terms.harmonic_torsions[3].l, 11);
  EXPECT_DOUBLE_EQ(scene.terms.harmonic_torsions[0].angle, std::numbers::pi);
  ASSERT_EQ(scene.terms.pulls.size(), 6u);
  EXPECT_EQ(scene.terms.pulls[5].atom, 11);
  EXPECT_EQ(scene.terms.gravity, Vec3(0, 0, -1));
  EXPECT_EQ(scene.system.mass, (Eigen::VectorXd{{2, 1, 2, 1, 2, 1, 2, 1, 2, 1, 2, 1}}));
  EXPECT_FALSE(scene.terms.nonbonded);
}

// Kremer and Grest's chains: springs beside a repulsion that bonded beads feel, too.
TEST(Molecules, OfRepulsiveBeads) {
  const std::string text = R"([molecule.chain]
atoms = [{name = "B", mass_u = 1, sigma_nm = 1, epsilon_kj_mol = 1}]
units = 10
fene = [[0, 1, 30, 1.5]]
exclude = "none"
[[place]]
molecule = "chain"
count = 4
[build]
density_per_nm3 = 0.2
[forcefield]
pair = "wca"
)";
  const Scene scene = read(text);
  EXPECT_EQ(scene.terms.fene.size(), 36u);
  ASSERT_TRUE(scene.terms.wca);
  EXPECT_FALSE(scene.terms.nonbonded);
  EXPECT_TRUE(scene.terms.wca->exclusions.empty());
  EXPECT_NEAR(scene.start.box.volume(), 200, 1e-9);
  EXPECT_NEAR((scene.start.x.col(1) - scene.start.x.col(0)).norm(), 0.97, 1e-12);
  EXPECT_EQ(read(with(text, "exclude = \"none\"", "")).terms.wca->exclusions.size(), 4u * (9 + 8));
  EXPECT_THAT(complaint(with(text, "[[place]]",
                             "[molecule.wide]\natoms = [{name = \"W\", mass_u = 1, sigma_nm = 2, "
                             "epsilon_kj_mol = 1}]\n[[place]]\nmolecule = \"wide\"\ncount = 1\n"
                             "[[place]]")),
              HasSubstr("forcefield.pair: wca takes one sigma_nm and one epsilon_kj_mol for all atoms"));
}

const std::string kSolution = kPolymers + R"([molecule.Na]
atoms = [{name = "NA", mass_u = 22.99, charge_e = 1, sigma_nm = 0.26, epsilon_kj_mol = 0.4, element = "Na"}]
[[place]]
molecule = "tip3p"
[[place]]
molecule = "Na"
count = 4
)";

// Water fills what is left, about as densely as it is.
TEST(Place, WaterFillsWhatIsLeft) {
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
TEST(Place, IsOverriddenByItsNumber) {
  EXPECT_EQ(read(kPolymers, {"place.0.count=5"}).system.atoms(), 100);
  const Scene heavy =
      read(kPolymers, {"molecule.polymer.atoms.0.mass_u=9", "molecule.polymer.bonds.0=[0, 1, 0.5]"});
  EXPECT_EQ(heavy.system.mass[0], 9);
  EXPECT_EQ(heavy.system.bonds[3].length, 0.5);
  EXPECT_THAT(complaint(kPolymers, {"place.1.count=5"}),
              HasSubstr("--set place.1.count=5: there is no \"1\" in a list of 1, counted from 0"));
  EXPECT_THAT(complaint(kPolymers, {"place.0.count=x"}),
              HasSubstr("--set place.0.count=x: place.0.count: expected an integer, got a string"));
  EXPECT_THAT(complaint(kPolymers, {"build.molecules=5"}), HasSubstr("place.0.count"));
}

TEST(Place, OnALatticeAboutCentresAndInShapes) {
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
TEST(Place, FromFiles) {
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
  EXPECT_EQ(source_of(scene, false, {}).read().start.x, scene.start.x);

  // A box that is not reduced is, and the run's notes say so.
  folder.write("two.gro", with(two_molecules, "   2.0   2.0   2.0", " 2 2 2 0 0 -2 0 0 1"));
  const Scene skewed = read_scene(file);
  EXPECT_EQ(skewed.start.box.tilt, Vec3(0, 0, 1));
  ASSERT_EQ(skewed.notes.size(), 1u);
  EXPECT_THAT(skewed.notes[0], HasSubstr("two.gro: its box is reduced to bx = 0, cx = 0, cy = 1 nm (b + a)"));

  const auto said = [&](const std::string& old, const std::string& changed) {
    folder.write("scene.toml", with(text, old, changed));
    try {
      read_scene(file);
    } catch (const InputError& e) {
      return std::string(e.what()).substr(folder.path().string().size() + 1);
    }
    return std::string("no error");
  };
  EXPECT_EQ(said("0.15", "0.9"),
            "scene.toml:6: place.0.file: atoms 0 and 1 are 0.15 nm apart, their bond is 0.9: are they in the "
            "molecule's order?");
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
TEST(Place, GoesOnInTheBoxOfAStart) {
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
TEST(Place, NotesOfTheStart) {
  EXPECT_THAT(read(kPolymers).notes, testing::ElementsAre(HasSubstr("equilibrate")));
  EXPECT_THAT(read(kPolymers, {"run.temperature_k=300", "run.thermostat=langevin"}).notes,
              testing::IsEmpty());
  const std::string dense = with(kPolymers, "count = 3", "count = 60");
  EXPECT_THAT(read(dense).notes, testing::Contains(HasSubstr("run.minimise = true relaxes it")));
  EXPECT_THAT(read(dense, {"run.minimise=true"}).notes, testing::IsEmpty());
  EXPECT_THAT(read(kSolution).notes, testing::Not(testing::Contains(HasSubstr("water cut to fit"))));
}

}  // namespace
}  // namespace taut::molecules_tests
