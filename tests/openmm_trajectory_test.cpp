// Trajectories against OpenMM's, and what the importer makes a scene of.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "constraints/methods/rattle.hpp"
#include "constraints/projection.hpp"
#include "constraints/registry.hpp"
#include "forcefield/force_field.hpp"
#include "md/observables.hpp"
#include "openmm_folder.hpp"
#include "studies/bond_lengths.hpp"
#include "studies/crosscheck.hpp"
#include "studies/crosscheck_verdict.hpp"
#include "studies/openmm_twin.hpp"
#include "systems/openmm/import.hpp"
#include "systems/scene/scene_file.hpp"

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

using ::testing::AllOf;
using ::testing::HasSubstr;

// OpenMM's own settings are rows. SETTLE's error is rounding to float, at any tolerance; CCMA's is the tolerance.
TEST(BondLengths, SayWhatTheyAreMadeOf) {
  const auto of = [](const char* scene, const std::vector<std::string>& overrides) {
    CrosscheckPlan plan;
    plan.contestants = contestants({"newton"});
    plan.speed_seconds = 0;
    return crosscheck(read_scene(find_scene(scene), overrides), plan);
  };
  const auto row = [](const Crosscheck& c, const std::string& run) {
    for (const BondLengths& each : bond_lengths(c))
      if (each.run == run) return each;
    ADD_FAILURE() << "no row " << run;
    return BondLengths();
  };
  const Crosscheck water = of("water", {"run.steps=20", "build.molecules=64", "forcefield.cutoff_nm=0.55",
                                        "forcefield.switch_nm=0.5"}),
                   chains = of("freely_jointed", {"build.chains=5", "run.steps=40"});
  EXPECT_EQ(water.settled, water.bonds);
  for (const char* run : {"openmm rattle, SETTLE", "openmm verlet 1e-05, SETTLE"}) {
    EXPECT_NEAR(row(water, run).rms.value / water.float_rounding, 1, 0.01) << run;
    EXPECT_THAT(row(water, run).made_of, HasSubstr("float"));
  }
  EXPECT_EQ(chains.settled, 0);
  const BondLengths usual = row(chains, "openmm verlet 1e-05, CCMA"),
                    tight = row(chains, "openmm verlet 1e-08, CCMA");
  EXPECT_LT(usual.largest, 1.1e-5);
  EXPECT_GT(usual.rms.value, 50 * tight.rms.value);
  EXPECT_THAT(usual.made_of, HasSubstr("CCMA"));
  for (const Crosscheck* c : {&water, &chains}) {
    EXPECT_LT(row(*c, "newton").rms.value, 1e-12);
    EXPECT_FALSE(row(*c, "newton").drifts);
    EXPECT_THAT(bond_lengths_in_words(*c), AllOf(HasSubstr("newton"), HasSubstr("5 ps"), HasSubstr("chaos")));
  }
  EXPECT_THAT(headline(chains), HasSubstr("agrees"));
}

TEST(BondLengths, SayThatTheyDrift) {
  Crosscheck c{.scene = "", .openmm = "", .platform = ""};
  c.bonds = 1, c.parting = 100;
  Track& track = c.tracks.emplace_back();
  track.name = "none";
  for (long n = 0; n <= 100; ++n)
    track.samples.push_back(
        {.step = n, .t = 1e-3 * static_cast<double>(n), .bond_rms = 1e-8 * static_cast<double>(n)});
  const BondLengths of = bond_lengths(c).at(0);
  EXPECT_NEAR(of.slope.value, 1e-8 / 1e-6, 1e-6 * of.slope.value);
  for (Sample& s : track.samples) s.bond_rms += s.step % 2 ? 1e-9 : 0;
  EXPECT_FALSE(bond_lengths(c).at(0).drifts) << "too short to tell";
  c.long_enough = true;
  EXPECT_TRUE(bond_lengths(c).at(0).drifts);
  EXPECT_GE(of.in_a_ns, of.slope.value);
}

}  // namespace
}  // namespace taut::openmm_trajectory_tests
