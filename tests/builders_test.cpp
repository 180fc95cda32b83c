// The scenes, and the builders behind them: geometry, density, distributions, parameters.

#include "systems/builders/builders.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "forcefield/force_field.hpp"
#include "md/observables.hpp"
#include "md/units.hpp"
#include "named_scene.hpp"
#include "scene_energy.hpp"
#include "systems/scene/start_file.hpp"
#include "temporary_folder.hpp"

namespace taut::builders_tests {
namespace {

std::vector<std::string> all_scenes() {
  std::vector<std::string> names;
  for (const auto& scene : list_scenes()) names.push_back(scene.name);
  return names;
}

class EveryScene : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, EveryScene, testing::ValuesIn(all_scenes()),
                         [](const auto& scene) { return scene.param; });

TEST_P(EveryScene, StartsOnItsBondsWithFiniteForces) {
  Scene scene = scene_of(GetParam());
  EXPECT_GT(scene.hard_on.size(), 20u);
  EXPECT_LT(bond_errors(scene.system, scene.start.x).max, 1e-7);  // files of starts have nine digits
  ForceField forces(scene.system, scene.start.box, scene.terms);
  forces.evaluate(scene.system, scene.start);
  EXPECT_TRUE(scene.start.f.allFinite());
  EXPECT_TRUE(scene.start.v.allFinite());
  EXPECT_LT(scene.start.f.cwiseAbs().maxCoeff(), 1e4);  // no overlap [kJ/mol/nm]
}

TEST_P(EveryScene, IsTheSameEachTime) {
  const Scene a = scene_of(GetParam()), b = scene_of(GetParam());
  EXPECT_EQ(a.start.x, b.start.x);
  EXPECT_EQ(a.start.v, b.start.v);
  if (a.run.temperature_k > 0) {
    EXPECT_NE(a.start.v, scene_of(GetParam(), {"run.seed=2"}).start.v);
  }
}

TEST_P(EveryScene, DrawsMaxwellBoltzmannVelocities) {
  const Scene scene = scene_of(GetParam());
  if (scene.run.temperature_k == 0) return;
  const double kT = kBoltzmann * scene.run.temperature_k;
  for (int axis = 0; axis < 3; ++axis) {  // ⟨mv²⟩ = kT, with variance 2(kT)²/n
    const double n = scene.system.atoms();
    const double mean = scene.start.v.row(axis).cwiseAbs2().dot(scene.system.mass.transpose()) / n;
    EXPECT_NEAR(mean / kT, 1, 5 * std::sqrt(2 / n));
  }
}

// Where nothing outside holds or pulls, velocities are drawn without a total momentum.
TEST_P(EveryScene, StartsWithoutMomentumWhereItIsKept) {
  const Scene scene = scene_of(GetParam());
  if (scene.run.temperature_k == 0 || !scene.closed()) return;
  const double scale = std::sqrt(2 * kinetic_energy(scene.system, scene.start.v) * scene.system.mass.sum());
  EXPECT_LT(momentum(scene.system, scene.start.v).norm(), 1e-12 * scale);
}

// u_k·u_{k+1} of every angle of every chain.
double mean_square_cosine(const Scene& scene, int beads) {
  double sum = 0;
  int count = 0;
  for (int a = 0; a + 2 < scene.system.atoms(); ++a) {
    if (a % beads > beads - 3) continue;
    const auto& x = scene.start.x;
    const double c = (x.col(a + 1) - x.col(a)).dot(x.col(a + 2) - x.col(a + 1));
    sum += c * c;
    ++count;
  }
  return sum / count;
}

// Without the measure √det A both would be ⅓, more than six standard errors away.
TEST(Chains, AnglesFollowTheMeasureOfRigidBonds) {
  EXPECT_NEAR(mean_square_cosine(scene_of("trimer", {"build.chains=40000"}), 3), 0.32102, 0.005);

  double weights = 0, squares = 0;  // four beads: det A ∝ 8 − 2c² − 2d², by the midpoint rule
  for (int i = 0; i < 200; ++i)
    for (int j = 0; j < 200; ++j) {
      const double c = (i + 0.5) / 200, d = (j + 0.5) / 200, w = std::sqrt(8 - 2 * c * c - 2 * d * d);
      weights += w;
      squares += w * c * c;
    }
  const Scene four = scene_of("trimer", {"build.chains=40000", "build.beads=4"});
  EXPECT_NEAR(mean_square_cosine(four, 4), squares / weights, 0.004);
}

TEST(Chains, AreFreelyJointed) {
  for (const int beads : {20, 60}) {  // drawn by the measure, and not
    const int chains = 4000;
    const Scene scene =
        scene_of("freely_jointed", {"build.chains=4000", "build.beads=" + std::to_string(beads)});
    double r2 = 0;  // ⟨R²⟩ = N b², with a standard error of √(2/3/4000) of it
    for (int c = 0; c < chains; ++c)
      r2 += (scene.start.x.col((c + 1) * beads - 1) - scene.start.x.col(c * beads)).squaredNorm() / chains;
    EXPECT_NEAR(r2 / (beads - 1), 1, 0.065);
    EXPECT_EQ(scene.notes.empty(), beads == 20);
  }
}

// A chain is a residue.
TEST(Chains, BeadsAreNamedByTheirChain) {
  const Scene scene = scene_of("freely_jointed", {"build.chains=3", "build.beads=4"});
  EXPECT_EQ(scene.names.residue, (std::vector<int>{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2}));
  EXPECT_EQ(scene.names.kinds[scene.names.kind[5]].atom, "BEAD");
}

double least_distance(const Scene& scene, int bonds_apart) {
  double least = 1e9;
  for (int a = 0; a < scene.system.atoms(); ++a)
    for (int b = a + bonds_apart + 1; b < scene.system.atoms(); ++b)
      least =
          std::min(least, scene.start.box.nearest_image(scene.start.x.col(b) - scene.start.x.col(a)).norm());
  return least;
}

std::string water_start() {
  return "build.start=" + (scenes_folder() / "water216.start.toml").string();
}

// On the lattice, whatever the counts, which are none of the start's: nothing overlaps and the density is
// exact.
TEST(Melt, FillsABoxWithoutOverlap) {
  const std::pair<int, int> sizes[] = {{20, 51}, {13, 31}, {7, 100}, {60, 8}, {1, 700}};
  for (const auto& [chains, beads] : sizes) {
    const Scene scene =
        scene_of("melt", {"build.chains=" + std::to_string(chains), "build.beads=" + std::to_string(beads)});
    SCOPED_TRACE(testing::Message() << chains << " × " << beads);
    EXPECT_EQ(scene.system.bond_count(), chains * (beads - 1));
    EXPECT_NEAR(scene.system.atoms() / scene.start.box.volume(), 0.85, 1e-12);
    EXPECT_GT(least_distance(scene, 1), 0.9699);
    EXPECT_LT(bond_errors(scene.system, scene.start.x).max, 1e-12);
    EXPECT_LT(energy_of(scene) / scene.system.atoms(), 0.5);  // in kT
  }
}

TEST(Melt, OfFeneSprings) {
  const Scene scene = scene_of("melt", {"build.bonds=fene"});
  EXPECT_EQ(scene.system.bond_count(), 0);
  ASSERT_EQ(scene.terms.fene.size(), 20u * 49u);
  EXPECT_EQ(scene.terms.fene[0].k, 30);
  EXPECT_EQ(scene.terms.fene[0].r0, 1.5);
  EXPECT_TRUE(scene.terms.wca->exclusions.empty());  // the pair force acts along the springs too
}

TEST(Decane, HasItsDensityAndItsStart) {
  for (const int molecules : {128, 60}) {
    const Scene scene =
        scene_of("decane", {"place.0.count=" + std::to_string(molecules), "forcefield.cutoff_nm=1.1"});
    // 142.286 g/mol; 1 g/cm³ is 602.214076 u/nm³
    EXPECT_NEAR(scene.system.mass.sum() / scene.start.box.volume() / 602.214076, 0.73, 1e-12);
    EXPECT_NEAR(scene.system.mass.sum() / molecules, 142.286, 1e-9);
    EXPECT_LT(bond_errors(scene.system, scene.start.x).max, 1e-7);
  }
  EXPECT_THAT(scene_of("decane").notes, testing::IsEmpty());
  EXPECT_GT(least_distance(scene_of("decane"), 9), 0.3);
  EXPECT_THAT(scene_of("decane", {"molecule.decane.units=6"}).notes,
              testing::Contains(testing::HasSubstr("decane.start.toml is set aside")));
}

// TraPPE's own form of the torsion, kelvin and all, against the coefficients and against the force field.
TEST(Decane, TorsionIsTraPPEs) {
  const auto trappe = [](double phi) {
    return kBoltzmann * (355.03 * (1 + std::cos(phi)) - 68.19 * (1 - std::cos(2 * phi)) +
                         791.32 * (1 + std::cos(3 * phi)));
  };
  const Scene scene = scene_of("decane");
  ASSERT_EQ(scene.terms.rb_torsions.size(), 128u * 7u);
  const System four = make_system(Eigen::VectorXd::Ones(4), {});
  Terms terms;
  terms.rb_torsions.push_back(scene.terms.rb_torsions.front());
  ForceField forces(four, {}, terms);
  for (int degrees = -180; degrees <= 180; degrees += 15) {
    const double phi = degrees * std::numbers::pi / 180;
    State s;
    s.x.resize(3, 4);
    s.f = Vectors::Zero(3, 4);
    s.x << 1, 0, 0, std::cos(phi), 0, 0, 0, std::sin(phi), 0, 0, 1, 1;  // trans at φ = 180°
    EXPECT_NEAR(forces.evaluate_energy(four, s), trappe(phi), 1e-12) << degrees;
  }
}

// TraPPE's CH3 and CH2.
TEST(Decane, EndsAndMiddlesHaveTheirNumbers) {
  const Scene scene = scene_of("decane");
  const Nonbonded& lj = *scene.terms.nonbonded;
  for (int a = 0; a < 40; ++a) {
    const bool end = a % 10 == 0 || a % 10 == 9;
    EXPECT_EQ(lj.sigma[a], end ? 0.375 : 0.395);
    EXPECT_EQ(lj.epsilon[a], (end ? 98 : 46) * kBoltzmann);
  }
  EXPECT_EQ(lj.exceptions.size(), 128u * (9 + 8 + 7));
  ASSERT_EQ(scene.terms.angles.size(), 128u * 8);
  EXPECT_EQ(scene.terms.angles[0].stiffness, 62500 * kBoltzmann);
  EXPECT_EQ(scene.terms.angles[0].angle, 114 * std::numbers::pi / 180);
}

// Numbers of OpenMM's tip3p.xml, and of Berendsen et al. 1987.
TEST(Water, ModelsHaveTheirNumbers) {
  const Scene tip3p = scene_of("water"), spce = scene_of("spce");
  EXPECT_EQ(tip3p.system.bonds[0].length, 0.09572);
  EXPECT_NEAR(tip3p.system.bonds[2].length, 0.15139006545273223, 1e-16);
  EXPECT_EQ(spce.system.bonds[1].length, 0.1);
  EXPECT_NEAR(spce.system.bonds[2].length, 0.16329, 1e-5);
  for (const Scene& scene : {tip3p, spce}) {
    EXPECT_EQ(scene.system.bond_count(), 3 * 216);
    EXPECT_EQ(scene.terms.nonbonded->exceptions.size(), 3u * 216u);
    EXPECT_NEAR(scene.terms.nonbonded->charge.head(3).sum(), 0, 1e-16);
    EXPECT_TRUE(scene.notes.empty());
  }
  EXPECT_EQ(tip3p.terms.nonbonded->charge[0], -0.834);
  EXPECT_EQ(spce.terms.nonbonded->charge[0], -0.8476);
}

// The cutoff is less than half the small box: eight boxes side by side have eight times its energy.
TEST(Water, IsTiledFromAnEquilibratedStart) {
  const std::string pairs_alone =
      "forcefield.dispersion_correction=false";  // the correction counts self-pairs
  const Scene one = scene_of("water", {pairs_alone});
  const Scene eight = scene_of("water", {pairs_alone, "build.molecules=1728"});
  EXPECT_NEAR(eight.start.box.edge.x(), 2 * one.start.box.edge.x(), 1e-12);
  EXPECT_NEAR(energy_of(eight) / energy_of(one), 8, 1e-9);
  EXPECT_NEAR(energy_of(one) / 216, -40, 1.5);  // of liquid TIP3P, not of a lattice
  EXPECT_TRUE(eight.notes.empty());
}

// Cut from it and settled: as dense, with a molecule's energy what it was, and no two in one place.
TEST(Water, OfAnyOtherNumberIsCutFromAnEquilibratedStart) {
  for (const int molecules : {150, 500}) {
    const Scene scene =
        scene_of("water", {"build.molecules=" + std::to_string(molecules), "forcefield.cutoff_nm=0.8"});
    EXPECT_TRUE(scene.notes.empty());
    EXPECT_FALSE(scene.positions_drawn);
    EXPECT_NEAR(scene.start.box.volume() / molecules, std::pow(1.872, 3) / 216, 1e-12);
    EXPECT_LT(bond_errors(scene.system, scene.start.x).max, 1e-12);
    EXPECT_NEAR(energy_of(scene) / molecules,
                energy_of(scene_of("water", {"forcefield.cutoff_nm=0.8"})) / 216, 0.2);
    EXPECT_GT(least_distance(scene, 2), 0.13);  // of a hydrogen bond
    double o_o = 1e9;
    for (int a = 0; a < 3 * molecules; a += 3)
      for (int b = a + 3; b < 3 * molecules; b += 3)
        o_o =
            std::min(o_o, scene.start.box.nearest_image(scene.start.x.col(b) - scene.start.x.col(a)).norm());
    EXPECT_GT(o_o, 0.235);
  }
}

TEST(Water, FillsBoxesOfOtherShapes) {
  const double volume = std::pow(1.872, 3) / 216 * 500;
  for (const auto& [shape, share, height] :
       {std::tuple{"octahedron", 4 * std::sqrt(3.0) / 9, std::sqrt(6.0) / 3},
        {"dodecahedron", std::sqrt(0.5), std::sqrt(0.5)}}) {
    const Scene scene = scene_of("water", {"build.molecules=500", std::string("build.box=") + shape});
    const Box& box = scene.start.box;
    EXPECT_EQ(Box::flaw(box.vectors()), "");
    EXPECT_NEAR(box.volume(), volume, 1e-12);
    for (int d = 0; d < 3; ++d) EXPECT_NEAR(box.vectors().col(d).norm(), std::cbrt(volume / share), 1e-12);
    EXPECT_NEAR(box.edge.minCoeff(), height * box.edge.x(), 1e-12);
    double least = 1e9;
    for (int a = 0; a < 1500; a += 3)
      for (int b = a + 3; b < 1500; b += 3)
        least = std::min(least, box.nearest_image(scene.start.x.col(b) - scene.start.x.col(a)).norm());
    EXPECT_GT(least, 0.235);
    EXPECT_TRUE(scene.notes.empty());
    EXPECT_NEAR(energy_of(scene) / 500, -40, 1.5);
  }
  EXPECT_THROW(scene_of("water_cluster", {"build.box=octahedron"}), InputError);
}

// The last state of a run in one is a start of it, and of eight side by side.
TEST(Water, GoesOnInABoxOfAnotherShape) {
  const TemporaryFolder folder;
  const auto shape = "build.box=dodecahedron";
  const Scene one = scene_of("water", {"build.molecules=500", shape});
  write_start(folder.path() / "a.start.toml", one.start);
  const std::string start = "build.start=" + (folder.path() / "a.start.toml").string();
  const auto energy = [](Scene scene) {
    scene.terms.nonbonded->dispersion_correction = false;
    return energy_of(scene);
  };
  const Scene again = scene_of("water", {"build.molecules=500", start});
  EXPECT_EQ(again.start.box, one.start.box);
  EXPECT_NEAR(energy(again), energy(one), 1e-9 * std::abs(energy(one)));
  const Scene eight = scene_of("water", {"build.molecules=4000", start, shape});
  EXPECT_NEAR(energy(eight), 8 * energy(one), 1e-8 * std::abs(energy(one)));
}

TEST(Water, OnALatticeHasTheDensityAskedFor) {
  const TemporaryFolder folder;
  const auto file = folder.write("lattice.toml",
                                 "hard_on = 'density'\n[build]\nkind = 'water'\nmodel = 'spce'\n"
                                 "shape = 'box'\nmolecules = 300\ndensity_g_cm3 = 0.9\n"
                                 "[forcefield]\ncutoff_nm = 0.9\n");
  const Scene scene = read_scene(file);
  EXPECT_NEAR(scene.system.mass.sum(), 300 * 18.0154, 1e-9);
  EXPECT_NEAR(scene.system.mass.sum() / scene.start.box.volume() / 602.214076, 0.9, 1e-12);
}

// A droplet's waters move as those of the start they are cut from.
TEST(Water, OfADropletKeepTheirVelocities) {
  const State bulk = read_start(scenes_folder() / "water216.start.toml");
  const Scene drop = scene_of("water_cluster", {water_start(), "build.molecules=20", "run.temperature_k=0"});
  for (int m = 0; m < 20; ++m) {
    Eigen::Index nearest = 0;
    double least = 1e9;
    for (Eigen::Index o = 0; o < 3 * 216; o += 3) {
      const Vec3 apart = drop.start.x.col(3 * m) - bulk.x.col(o);
      if (const double d = bulk.box.nearest_image(apart).norm(); d < least) least = d, nearest = o;
    }
    EXPECT_LT(least, 1e-12);
    EXPECT_EQ(Vectors(drop.start.v.middleCols(3 * m, 3)), Vectors(bulk.v.middleCols(nearest, 3)));
  }
}

TEST(Water, DropletIsRoundAndDense) {
  for (const int molecules : {64, 400}) {  // within the start, and beyond it
    const Scene scene =
        scene_of("water_cluster", {water_start(), "build.molecules=" + std::to_string(molecules)});
    EXPECT_FALSE(scene.start.box.periodic());
    EXPECT_FALSE(scene.terms.nonbonded->cutoff.has_value());
    Vectors o(3, molecules);
    for (int m = 0; m < molecules; ++m) o.col(m) = scene.start.x.col(3 * m);
    const double radius = (o.colwise() - Vec3(o.rowwise().mean())).colwise().norm().maxCoeff();
    const double ideal = std::cbrt(0.75 * molecules * std::pow(1.872, 3) / 216 / std::numbers::pi);
    EXPECT_NEAR(radius, ideal, 0.1);
  }
}

}  // namespace
}  // namespace taut::builders_tests
