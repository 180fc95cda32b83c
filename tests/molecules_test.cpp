// Molecules that are given in a scene: their shapes, their bonds and their forces.

#include <fmt/format.h>

#include <numbers>

#include "md/observables.hpp"
#include "md/units.hpp"
#include "polymer_scene.hpp"
#include "scene_energy.hpp"

namespace taut::molecules_tests {
namespace {

using testing::HasSubstr;

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
  const Scene scene = read(R"(place = [{molecule = "chain", count = 20}, {molecule = "ring", count = 20}]
[molecule.chain]
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
  const Scene ring = read(R"(place = [{molecule = "ring", count = 5}, {molecule = "methane", count = 2}]
[molecule.ring]
atoms = [{name = "B", mass_u = 1, sigma_nm = 0.9, epsilon_kj_mol = 1}]
units = 8
ring = true
bonds = [[0, 1, 1.0]]
[molecule.methane]
atoms = [{name = "C", mass_u = 12.011}, {name = "H1", mass_u = 1.008}, {name = "H2", mass_u = 1.008},
  {name = "H3", mass_u = 1.008}, {name = "H4", mass_u = 1.008}]
bonds = [[0, 1, 0.109], [0, 2, 0.109], [0, 3, 0.109], [0, 4, 0.109]]
angles = [[1, 0, 2, 109.4712206, 1], [1, 0, 3, 109.4712206, 1], [1, 0, 4, 109.4712206, 1],
  [2, 0, 3, 109.4712206, 1], [2, 0, 4, 109.4712206, 1], [3, 0, 4, 109.4712206, 1]]
)");
  EXPECT_EQ(ring.system.bond_count(), 5 * 8 + 2 * 4);
  EXPECT_LT(bond_errors(ring.system, ring.start.x).max, 1e-9);
  Scene bends = ring;
  bends.terms.nonbonded.reset();
  EXPECT_LT(energy_of(bends), 1e-9);
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
  const Scene scene = read(R"(atom.BB = {mass_u = 2}
atom.SC = {mass_u = 1}
place = [{molecule = "brush", count = 2}]
build = {gravity_nm_ps2 = [0, 0, -1]}
[molecule.brush]
atoms = ["BB", "SC"]
units = 3
bonds = [[0, 1, 0.2], [0, 2, 0.3]]
springs = [[1, 3, 0.4, 10]]
impropers = [[1, 0, 2, 3, 180, 5]]
pulls = [[1, 0, 0, 7]]
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
  const std::string text = R"(place = [{molecule = "chain", count = 4}]
build = {density_per_nm3 = 0.2}
forcefield = {pair = "wca"}
[molecule.chain]
atoms = [{name = "B", mass_u = 1, sigma_nm = 1, epsilon_kj_mol = 1}]
units = 10
fene = [[0, 1, 30, 1.5]]
exclude = "none"
)";
  const Scene scene = read(text);
  EXPECT_EQ(scene.terms.fene.size(), 36u);
  ASSERT_TRUE(scene.terms.wca);
  EXPECT_FALSE(scene.terms.nonbonded);
  EXPECT_TRUE(scene.terms.wca->exclusions.empty());
  EXPECT_NEAR(scene.start.box.volume(), 200, 1e-9);
  EXPECT_NEAR((scene.start.x.col(1) - scene.start.x.col(0)).norm(), 0.97, 1e-12);
  EXPECT_EQ(read(with(text, "exclude = \"none\"", "")).terms.wca->exclusions.size(), 4u * (9 + 8));
  EXPECT_THAT(scene.notes, testing::Not(testing::Contains(HasSubstr("fene"))));
  EXPECT_THAT(read(with(text, "exclude = \"none\"", "")).notes,
              testing::Contains(HasSubstr("fene: nothing keeps the ends of 36 springs apart")));
}

// Ewald's sum of a charged box is that of another system.
TEST(Molecules, ThatAreChargedAllInAllAreNoted) {
  const std::string ions = R"(place = [{molecule = "sodium", count = 3}, {molecule = "chloride", count = 2}]
build = {box_nm = 3}
forcefield = {cutoff_nm = 1, coulomb = "pme"}
[molecule.sodium]
atoms = [{name = "NA", mass_u = 22.99, charge_e = 1, sigma_nm = 0.24, epsilon_kj_mol = 0.37}]
[molecule.chloride]
atoms = [{name = "CL", mass_u = 35.45, charge_e = -1, sigma_nm = 0.45, epsilon_kj_mol = 0.15}]
)";
  const auto charged = testing::Contains(HasSubstr("the charges add up to 1 e, which PME neutralises by"));
  EXPECT_THAT(read(ions).notes, charged);
  EXPECT_THAT(read(ions, {"place.1.count=3"}).notes, testing::Not(charged));
  EXPECT_THAT(read(ions, {"forcefield.coulomb=cutoff"}).notes, testing::Not(charged));

  Scene back = through_openmm(read(ions));  // and of OpenMM
  apply_overrides(back, {"run.seed=1", "run.temperature_k=300"});
  EXPECT_THAT(back.notes, charged);
}

}  // namespace
}  // namespace taut::molecules_tests
