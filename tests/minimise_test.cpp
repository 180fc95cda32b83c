// Rough starts: overlaps relaxed with every bond at its length.

#include "simulation/minimise.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.hpp"
#include "forcefield/force_field.hpp"
#include "md/observables.hpp"
#include "polymer_scene.hpp"
#include "simulation/simulation.hpp"

namespace taut::minimise_tests {
namespace {

using ::testing::HasSubstr;

// Every second molecule of `size` atoms pushed by up to `far` [nm].
void push(Vectors& x, int size, double far) {
  Random random(9);
  for (int first = 0; first < x.cols(); first += 2 * size)
    x.middleCols(first, size).colwise() += far * Vec3(random.unit_vector());
}

TEST(Minimise, OverlappingWatersComeApart) {
  Scene scene = read_scene(find_scene("water"), {"build.molecules=216"});
  push(scene.start.x, 3, 0.15);
  ForceField forces(scene.system, scene.start.box, scene.terms);
  const Minimised result = minimise(scene.system, forces, {1000}, scene.start);
  EXPECT_GT(result.energy_before, 1e5);
  EXPECT_LT(result.energy, -5000);
  EXPECT_LE(result.largest_force, 1000);
  EXPECT_LT(bond_errors(scene.system, scene.start.x).max, 1e-12);
}

// Two chains on top of each other, atom by atom, whose energy is no number: soft forces part them, and the pair forces
// then take over.
TEST(SoftStart, PartsAtomsInOnePlace) {
  Scene piled = read_scene(find_scene("melt"), {"build.chains=20", "build.beads=10"});
  const int each = 10;
  piled.start.x.middleCols(each, each) = piled.start.x.leftCols(each);
  piled.run.minimise = true;
  EXPECT_THROW(Simulation{piled}, InputError);
  piled.run.soft_start = true;
  const Simulation parted(piled);
  EXPECT_GT(*parted.start_report().pushed_apart, 0);
  EXPECT_LT(parted.start_report().minimised->largest_force, 1e3);
  double nearest = 9;
  for (int a = 0; a < each; ++a)
    for (int b = 0; b < each; ++b)
      nearest = std::min(nearest, (parted.state().x.col(a) - parted.state().x.col(each + b)).norm());
  EXPECT_GT(nearest, 0.8);  // σ is 1 nm
  EXPECT_LT(bond_errors(piled.system, parted.state().x).max, 1e-8);
}

// Chains that are to stand at one place have no room: where soft forces part them they are placed all the same.
TEST(SoftStart, PartsChainsThatFoundNoRoom) {
  EXPECT_THAT(complaint(kCrowd), HasSubstr("there is no room for copy 2 of 3"));
  const Simulation parted(read(kCrowd + kPartTheCrowd));
  EXPECT_GT(*parted.start_report().pushed_apart, 0);
  EXPECT_LT(parted.start_report().minimised->largest_force, 1e3);
}

// A pendulum falls to its lowest point and stays on its circle; its anchor, which is pulled, stays where it is.
TEST(Minimise, PendulumHangs) {
  const System sys = make_system(Eigen::Vector2d(0, 3), {{0, 1, 0.5}});
  ForceField forces(sys, {}, {.gravity = Vec3(0, 0, -10), .pulls = {{0, Vec3(100, 0, 0)}}});
  State s;
  Vectors& x = s.x = Vectors::Zero(3, 2);
  x(0, 1) = 0.5;
  const Minimised result = minimise(sys, forces, {1e-4}, s);
  EXPECT_EQ(Vec3(x.col(0)), Vec3::Zero());
  EXPECT_NEAR(x(2, 1), -0.5, 1e-9);
  EXPECT_NEAR(result.energy, -15, 1e-6);
  EXPECT_LE(result.largest_force, 1e-4);
}

// The way down does not ask for masses.
TEST(Minimise, MassesHaveNoSay) {
  const std::vector<RigidBond> bonds = {{0, 1, 0.5}, {1, 2, 0.5}};
  const auto end = [&](const Eigen::VectorXd& mass) {
    const System sys = make_system(mass, bonds);
    ForceField forces(sys, {}, {.pulls = {{0, Vec3(1, 2, 0)}, {1, Vec3(0, -5, 1)}, {2, Vec3(-1, 3, -1)}}});
    State s;
    Vectors& x = s.x;
    x.resize(3, 3);
    x << 0, 0.5, 0.5, 0, 0, 0.5, 0, 0, 0;
    const Minimised result = minimise(sys, forces, {1}, s);
    EXPECT_GT(result.moves, 3);
    return x;
  };
  EXPECT_EQ(end(Eigen::Vector3d(1, 1, 1)), end(Eigen::Vector3d(16, 1, 5)));
}

// Falling for ever: every move helps, none is longer than the longest, and there is a last one.
TEST(Minimise, GoesNoFurtherThanItsLongestMoves) {
  const System sys = make_system(Eigen::VectorXd::Ones(1), {});
  ForceField forces(sys, {}, {.gravity = Vec3(0, 0, -10)});
  State s;
  Vectors& x = s.x = Vectors::Zero(3, 1);
  const Minimised result = minimise(sys, forces, {1e-4}, s);
  EXPECT_EQ(result.moves, MinimiseGoal().most_moves);
  EXPECT_NEAR(-x(2, 0), MinimiseGoal().most_moves * kLongestMove, 20 * kLongestMove);
  int told = 0;
  double energy = 0;
  const Minimised few = minimise(sys, forces, {1e-4, 7}, s, [&](const Minimised& so_far) {
    EXPECT_EQ(so_far.moves, told++);
    EXPECT_LE(so_far.energy, energy);
    energy = so_far.energy;
  });
  EXPECT_EQ(few.moves, 7);
  EXPECT_EQ(told, 7);
  EXPECT_LT(few.energy, energy);
}

TEST(Minimise, ASceneAsksForItAndIsToldWhatItTook) {
  Scene scene = read_scene(find_scene("water"), {"run.minimise=true", "run.minimise_force_kj_mol_nm=2000"});
  push(scene.start.x, 3, 0.1);
  Random random(1);
  for (int a = 0; a < scene.system.atoms(); ++a)
    scene.start.v.col(a) = std::sqrt(scene.system.inv_mass[a]) * random.normal_vector();
  const Simulation simulation(scene);
  const StartReport& report = simulation.start_report();
  ASSERT_TRUE(report.minimised);
  EXPECT_LE(report.minimised->largest_force, 2000);
  EXPECT_LT(report.largest_move, 1e-9);
  EXPECT_NEAR(report.kinetic_removed, 1.0 / 3, 0.05);  // three of nine degrees of freedom
  EXPECT_FALSE(Simulation(read_scene(find_scene("water"))).start_report().minimised);
}

}  // namespace
}  // namespace taut::minimise_tests
