// Trajectories against OpenMM's, and what the importer makes a scene of.

#include <gtest/gtest.h>

#include "constraints/methods/rattle.hpp"
#include "constraints/projection.hpp"
#include "constraints/registry.hpp"
#include "forcefield/force_field.hpp"
#include "md/observables.hpp"
#include "openmm_folder.hpp"
#include "studies/openmm_twin.hpp"
#include "systems/openmm/import.hpp"

namespace taut::openmm_trajectory_tests {
namespace {

using tests::data;
using tests::Files;
using tests::Folder;

TEST(OpenMMScene, IsNamedAfterItsFileAndRunsNewton) {
  const Files files = data("ala2-hbonds-rf");
  const Scene scene = import_openmm(files.system, files.state);
  EXPECT_TRUE(built_with_openmm());
  EXPECT_EQ(scene.name, "ala2-hbonds-rf");
  EXPECT_EQ(scene.method.name(), "newton");
  EXPECT_FALSE(scene.hard_on.empty());
  EXPECT_EQ(scene.run.remove_momentum_every, 0);
  EXPECT_EQ(scene.system.atoms(), scene.start.x.cols());
  EXPECT_EQ(scene.terms.nonbonded->charge.size(), scene.system.atoms());
}

struct Apart {
  double x;      // largest distance between the two in a coordinate [nm]
  double v;      // the same of velocities [nm/ps]
  double bonds;  // OpenMM's own relative bond error
};

// The two after `steps` steps of 1 fs from the same start, which satisfies the bonds.
Apart apart_after(const Files& files, int steps) {
  constexpr double h = 0.001;
  Scene scene = import_openmm(files.system, files.state);
  const System& sys = scene.system;
  ForceField forces(sys, scene.start.box, scene.terms);
  Rattle::Options options;
  options.tolerance = 1e-12;
  Rattle rattle(sys, options, h);
  State& s = scene.start;
  initialize({sys, forces, rattle}, h, s);

  OpenMMTwin twin(files.system, files.state, {h});
  twin.set(s);
  twin.step(steps);
  for (int n = 0; n < steps; ++n) EXPECT_TRUE(step({sys, forces, rattle}, h, s).converged());

  const State theirs = twin.state();
  EXPECT_NEAR(s.t, theirs.t, 1e-9);
  return {.x = (s.x - theirs.x).cwiseAbs().maxCoeff(),
          .v = (s.v - theirs.v).cwiseAbs().maxCoeff(),
          .bonds = bond_errors(sys, theirs.x).max};
}

void expect_same_trajectory(const Apart& apart) {
  EXPECT_LT(apart.bonds, 1e-11);
  EXPECT_LT(apart.x, 1e-9);
  EXPECT_LT(apart.v, 1e-6);
}

TEST(OpenMMTrajectory, WatersWithoutSettle) {
  const Folder folder;
  expect_same_trajectory(apart_after(tests::without_settle(data("tip3p-216"), folder), 200));
}

TEST(OpenMMTrajectory, DipeptideWithAllBondsRigidWithoutSettle) {
  const Folder folder;
  const Files dipeptide = tests::all_bonds_rigid(data("ala2-hbonds-rf"), folder);
  expect_same_trajectory(apart_after(tests::without_settle(dipeptide, folder), 200));
}

TEST(OpenMMTrajectory, MeltWithAnchors) {
  const Folder folder;
  expect_same_trajectory(apart_after(tests::anchored_melt(folder), 100));
}

// OpenMM's sites are where the force at a step's end is taken.
TEST(OpenMMTrajectory, WatersWithVirtualSitesWithoutSettle) {
  for (const char* name : {"tip4pew-64", "tip5p-64"}) {
    const Folder folder;
    expect_same_trajectory(apart_after(tests::without_settle(data(name), folder), 100));
  }
}

// With SETTLE the two part at once by a float's rounding of the distances, and chaos does the rest.
TEST(OpenMMTrajectory, Waters) {
  const Apart apart = apart_after(data("tip3p-216"), 200);
  EXPECT_LT(apart.bonds, 6e-8);
  EXPECT_LT(apart.x, 1e-6);
}

TEST(OpenMMTrajectory, DipeptideWithAllBondsRigid) {
  const Folder folder;
  const Apart apart = apart_after(tests::all_bonds_rigid(data("ala2-hbonds-rf"), folder), 10);
  EXPECT_LT(apart.bonds, 6e-8);
  EXPECT_LT(apart.x, 1e-6);
}

}  // namespace
}  // namespace taut::openmm_trajectory_tests
