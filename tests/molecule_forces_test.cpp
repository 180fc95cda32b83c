// What acts in molecules that a scene says: every force, rows of one atom alone, ropes between molecules, and
// copies that are put into a part of the box.

#include <fmt/format.h>

#include <map>

#include "forcefield/force_field.hpp"
#include "scene_energy.hpp"
#include "scene_text.hpp"
#include "simulation/simulation.hpp"
#include "systems/molecules/whole_molecules.hpp"

namespace taut::molecule_forces_tests {
namespace {

const std::string kEvery = R"(atom.Z = {mass_u = 0}
place = [{molecule = "all", count = 2}]
build = {box_nm = 3, gravity_nm_ps2 = [0, 0, -1]}
forcefield = {cutoff_nm = 1}
run = {dt_fs = 0.5, steps = 200, temperature_k = 300}
[molecule.all]
atoms = [{name = "A", mass_u = 12, charge_e = 0.4, sigma_nm = 0.3, epsilon_kj_mol = 0.3}, "Z",
         {name = "B", mass_u = 14, charge_e = -0.4, sigma_nm = 0.3, epsilon_kj_mol = 0.3},
         {name = "C", mass_u = 12}, {name = "D", mass_u = 12, charge_e = 0.2}]
bonds = [[0, 2, 0.15]]
at_least = [[1, 3, 0.1]]
at_most = [[0, 3, 0.5]]
springs = [[0, 1, 0.2, 1000]]
fene = [[2, 3, 30, 0.3], [3, 4, 30, 0.3]]
angles = [[1, 0, 2, 110, 100], [0, 2, 3, 100, 200]]
torsions = [[1, 0, 2, 3, 3, 0, 2]]
rb_torsions = [[0, 2, 3, 4, 1, 2, 1, 0.5, 0.2, 0.1]]
impropers = [[1, 0, 2, 3, 60, 4]]
pulls = [[3, 10, 0, 0]]
restraints = [[4, 1, 2, 9.5, 50]]
)";

std::map<std::string, double> energies(const Scene& scene) {
  const Energies all = energies_of(scene);
  return {all.begin(), all.end()};
}

TEST(MoleculeForces, AllAct) {
  Scene scene = read(kEvery);
  const auto by_name = energies(scene);
  for (const char* force : {"bond", "angle", "torsion", "rb_torsion", "harmonic_torsion", "fene",
                            "lj_coulomb", "gravity", "pull", "restraint"}) {
    ASSERT_TRUE(by_name.contains(force)) << force;
    EXPECT_NE(by_name.at(force), 0) << force;
  }
  EXPECT_EQ(by_name.size(), 10u);
  EXPECT_EQ(scene.system.anchors(), 2);
  EXPECT_EQ(scene.system.one_sided.size(), 4u);

  double held = 0;  // 9.5 nm is 0.5 nm in the next box but two
  for (const int a : {4, 9}) {
    Vec3 d = scene.start.x.col(a) - Vec3(1, 2, 0.5);
    for (double& c : d) c = std::remainder(c, 3);
    held += 25 * d.squaredNorm();
  }
  EXPECT_NEAR(by_name.at("restraint"), held, 1e-9 * held);

  Simulation simulation(std::move(scene));
  const double before = simulation.record().total();
  simulation.run([](const Record&) {});
  EXPECT_NEAR(simulation.record().total(), before, 2e-2);
  EXPECT_LT(simulation.record().bonds.max, 1e-9);
}

// −1 is the last of all units: a rope from end to end, one pull, one tether.
TEST(MoleculeForces, RowsCountedFromTheEndCountOnce) {
  const Scene scene = read(R"([molecule.chain]
atoms = [{name = "A", mass_u = 1}, {name = "B", mass_u = 2}]
units = 4
bonds = [[0, 1, 0.3], [1, 2, 0.3]]
at_most = [[0, -1, 1.5]]
pulls = [[-1, 0, 0, 7]]
restraints = [[-8, 0, 0, 0, 5]]
[[place]]
molecule = "chain"
count = 2
)");
  ASSERT_EQ(scene.system.one_sided.size(), 2u);
  EXPECT_EQ(scene.system.one_sided[1].i, 8);
  EXPECT_EQ(scene.system.one_sided[1].j, 15);
  ASSERT_EQ(scene.terms.pulls.size(), 2u);
  EXPECT_EQ(scene.terms.pulls[1].atom, 15);
  ASSERT_EQ(scene.terms.restraints.size(), 2u);
  EXPECT_EQ(scene.terms.restraints[1].atom, 8);
}

// A force on each unit accelerates the whole, as does one of a pair of forces; not where an atom of the molecule is
// anchored or tethered, and not along the axis of a wall.
TEST(MoleculeForces, PullsThatMoveTheWholeOffAreSaid) {
  using ::testing::AllOf, ::testing::HasSubstr;
  const auto note_of = [](const std::string& pulls, const std::string& more = "", double first_u = 2) {
    const Scene scene = read(fmt::format(R"([atom.A]
mass_u = 2
sigma_nm = 0.3
epsilon_kj_mol = 1
[atom.F]
mass_u = {}
[molecule.chain]
atoms = ["A"]
first = "F"
units = 3
bonds = [[0, 1, 0.3]]
pulls = {}
{}
[[place]]
molecule = "chain"
centres_nm = [[1, 1, 1], [3, 1, 1]]
[build]
box_nm = 6
[forcefield]
cutoff_nm = 1
)",
                                         first_u, pulls, more));
    std::string all;
    for (const std::string& note : scene.notes)
      if (note.starts_with("pulls:")) all += note;
    return all;
  };
  EXPECT_THAT(note_of("[[0, 0, 0, 4]]"),  // 24 kJ/mol/nm on 12 u
              AllOf(HasSubstr("6 add up to [0, 0, 24]"), HasSubstr("by 2 nm/ps²"), HasSubstr("every unit")));
  EXPECT_THAT(note_of("[[-1, 3, 0, 0]]"), HasSubstr("2 add up to [6, 0, 0]"));
  EXPECT_EQ(note_of("[[-1, 0.1, 0.2, 0.3], [-3, -0.1, -0.2, -0.3]]"), "");
  EXPECT_EQ(note_of("[[-1, 0, 0, 4]]", "", 0), "") << "an anchor holds it";
  EXPECT_EQ(note_of("[[-1, 0, 0, 4]]", "restraints = [[-3, 0, 0, 0, 500]]"), "");
  EXPECT_EQ(note_of("[[-1, 0, 0, 4]]", "steered = [[-3, 0, 0, -0.1, 500]]"), "");
  const std::string wall =
      "[[wall]]\naxis = \"z\"\nbetween_nm = [0, 5]\nsigma_nm = 0.3\nepsilon_kj_mol = 1\n";
  EXPECT_EQ(note_of("[[-1, 0, 0, 4]]", wall), "");
  EXPECT_THAT(note_of("[[-1, 1, 0, 4]]", wall), HasSubstr("[2, 0, 0]"));
}

// A rope makes one molecule of two, which grow within its reach; their pair forces are left as they are.
TEST(MoleculeForces, ARopeTiesTwoMolecules) {
  const Scene scene = read(R"(place = [{molecule = "pair", count = 50}, {molecule = "two", count = 1}]
[molecule.two]
atoms = [{name = "A", mass_u = 1, sigma_nm = 0.3, epsilon_kj_mol = 1}]
units = 4
bonds = [[0, 1, 0.3]]
at_least = [[0, 3, 0.5]]
[molecule.pair]
atoms = [{name = "A", mass_u = 1, sigma_nm = 0.3, epsilon_kj_mol = 1}, {name = "B", mass_u = 1}]
at_most = [[0, 1, 0.6]]
)");
  for (int a = 0; a < 100; a += 2)
    EXPECT_NEAR((scene.start.x.col(a + 1) - scene.start.x.col(a)).norm(), 0.54, 1e-9);
  for (const auto& pair : scene.terms.nonbonded->exceptions) EXPECT_GE(pair.i, 100);
  const std::vector<int> molecule = molecules(scene.system, {});
  EXPECT_EQ(molecule[1], 0) << "what a change of the box must not draw apart";
  EXPECT_EQ(molecule.back(), 50);
}

// Anchors in a plane, 0.4 nm apart, and a chain that stays where it was put.
TEST(MoleculeForces, CopiesArePutIntoAPartOfTheBox) {
  const Scene scene = read(R"(atom.W = {mass_u = 0, sigma_nm = 0.4, epsilon_kj_mol = 1}
molecule.wall = {atoms = ["W"]}
molecule.ball = {atoms = [{name = "B", mass_u = 1, sigma_nm = 0.3, epsilon_kj_mol = 1}]}
place = [{molecule = "wall", count = 100, arrange = "lattice", within_nm = [0, 0, 0, 4, 4, 0.1]},
  {molecule = "ball", count = 20, within_nm = [1, 1, 2, 3, 3, 3]}]
build = {box_nm = 4}
forcefield = {cutoff_nm = 1}
)");
  const Vectors wall = scene.start.x.leftCols(100), balls = scene.start.x.rightCols(20);
  EXPECT_NEAR((wall.row(2).array() - 0.05).abs().maxCoeff(), 0, 1e-12);
  for (int a = 1; a < 10; ++a) EXPECT_NEAR(wall(0, a) - wall(0, a - 1), 0.4, 1e-9);
  EXPECT_NEAR(wall(1, 99), 3.8, 1e-9);
  EXPECT_TRUE((balls.array() >= 1).all() && (balls.array() <= 3).all() && (balls.row(2).array() >= 2).all());
  EXPECT_GT(balls.row(0).maxCoeff() - balls.row(0).minCoeff(), 1);
}

// Each pair of kinds has its own σ and ε: by Lorentz and Berthelot's rule, or those of a [[pair]].
TEST(MoleculeForces, OfRepulsiveBeadsAreOfEachPairOfKinds) {
  const std::string text =
      R"(molecule.small = {atoms = [{name = "S", mass_u = 1, sigma_nm = 0.3, epsilon_kj_mol = 1}]}
molecule.wide = {atoms = [{name = "W", mass_u = 2, sigma_nm = 0.5, epsilon_kj_mol = 4}]}
molecule.none = {atoms = [{name = "N", mass_u = 2}]}
place = [{molecule = "small", centres_nm = [[0, 0, 0], [0.28, 0, 0], [5, 0.46, 0]]},
  {molecule = "wide", centres_nm = [[0, 0.38, 0], [5, 0, 0]]},
  {molecule = "none", centres_nm = [[0.1, 0.1, 0]]}]
forcefield = {pair = "wca"}
run = {dt_fs = 0.1, steps = 2000}
)";
  const auto wca = [](double sigma, double epsilon, double r) {
    const double s6 = std::pow(sigma / r, 6);
    return s6 > 0.5 ? epsilon * (4 * (s6 * s6 - s6) + 1) : 0.0;
  };
  const double across = std::hypot(0.28, 0.38);
  const Scene scene = read(text);
  EXPECT_FALSE(scene.terms.wca || scene.terms.nonbonded);
  EXPECT_EQ(scene.terms.tabulated_pairs->potentials.size(), 3u);
  EXPECT_NEAR(energy_of(scene), wca(0.3, 1, 0.28) + wca(0.4, 2, 0.38) + wca(0.4, 2, across), 1e-6);
  EXPECT_EQ(wca(0.4, 2, 0.46), 0);
  const Scene paired = read(text + "[[pair]]\natoms = [\"S\", \"W\"]\nsigma_nm = 0.42\nepsilon_kj_mol = 3\n");
  EXPECT_NEAR(energy_of(paired),
              wca(0.3, 1, 0.28) + wca(0.42, 3, 0.38) + wca(0.42, 3, across) + wca(0.42, 3, 0.46), 1e-6);
  EXPECT_NEAR(energy_of(through_openmm(paired)), energy_of(paired), 1e-9);
  Simulation simulation(scene);
  const double before = simulation.record().total();
  simulation.run({});
  EXPECT_NEAR(simulation.record().total(), before, 5e-4);  // 5 kJ/mol became motion
  EXPECT_GT(simulation.record().kinetic, 1);
  const SceneText chain{R"(place = [{molecule = "chain", count = 1}]
forcefield = {pair = "wca"}
[molecule.chain]
atoms = [{name = "S", mass_u = 1, sigma_nm = 0.3, epsilon_kj_mol = 1},
         {name = "W", mass_u = 2, sigma_nm = 0.5, epsilon_kj_mol = 4}]
units = 3
bonds = [[0, 1, 0.4], [1, 2, 0.4]]
lennard_jones_14 = 1
)"};
  expect_said(chain, {{"14 = 1", "14 = 0.5", "of wca pairs three bonds apart have all or nothing"}});
  EXPECT_EQ(read(chain.text).terms.tabulated_pairs->exclusions.size(), 5u + 4u);
}

}  // namespace
}  // namespace taut::molecule_forces_tests
