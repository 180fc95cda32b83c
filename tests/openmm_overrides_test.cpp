// Keys laid over the forces of a System that OpenMM prepared.

#include "forcefield/force_field.hpp"
#include "openmm_folder.hpp"
#include "openmm_texts.hpp"
#include "systems/openmm/import.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut::openmm_overrides_tests {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// tests/data/NAME with these keys laid over it.
Scene read_over(const std::string& name, const std::vector<std::string>& overrides) {
  const tests::Files files = tests::data(name);
  Scene scene = import_openmm(files.system, files.state);
  scene.notes.clear();
  apply_overrides(scene, overrides);
  return scene;
}

std::string refuse_over(const std::string& name, const std::string& override_) {
  return error_message([&] { read_over(name, {override_}); });
}

Vectors forces_of(const Scene& scene) {
  State state = scene.start;
  state.f = Vectors::Zero(3, state.x.cols());
  ForceField forces(scene.system, state.box, scene.terms);
  forces.evaluate(scene.system, state);
  return state.f;
}

// Mixed precision is the engine's own figure, 1e-6 of rms, on what OpenMM prepared, too; it is no other model.
TEST(OpenMMOverrides, MixedPrecisionServesWhatOpenMMPrepared) {
  for (const char* name : {"tip3p-216", "ala2-hbonds-rf", "ala3-charmm36", "every-force"}) {
    const Scene exact = read_over(name, {}), mixed = read_over(name, {"forcefield.precision=mixed"});
    EXPECT_EQ(mixed.terms.precision, Precision::kMixed) << name;
    EXPECT_THAT(mixed.notes, IsEmpty()) << name;
    const Vectors f = forces_of(exact);
    const double apart = (forces_of(mixed) - f).norm() / f.norm();
    EXPECT_GT(apart, 1e-12) << name << ": nothing was computed in another precision";
    EXPECT_LT(apart, 1e-5) << name;
  }
}

TEST(OpenMMOverrides, ANoteSaysWhereTheModelIsNotTheSystems) {
  const Scene scene = read_over("tip3p-216", {"forcefield.cutoff_nm=0.7", "forcefield.coulomb=pme"});
  EXPECT_EQ(scene.terms.nonbonded->cutoff, 0.7);
  EXPECT_TRUE(scene.terms.nonbonded->pme);
  EXPECT_THAT(scene.notes,
              ::testing::Contains(HasSubstr("asks for a cutoff of 0.7 nm; the System has 0.9 nm")));
  EXPECT_THAT(scene.notes, ::testing::Contains(HasSubstr("Coulomb by PME; the System has a reaction field")));
}

TEST(OpenMMOverrides, WhatIsNotSaidStaysTheSystems) {
  const Nonbonded given = *read_over("ala2-hbonds-rf", {}).terms.nonbonded;
  const Nonbonded same = *read_over("ala2-hbonds-rf", {"forcefield.precision=double"}).terms.nonbonded;
  EXPECT_EQ(same.cutoff, given.cutoff);
  EXPECT_EQ(same.switch_distance, given.switch_distance);
  EXPECT_EQ(same.rf_dielectric, given.rf_dielectric);
  EXPECT_EQ(same.dispersion_correction, given.dispersion_correction);
  EXPECT_EQ(same.pme.has_value(), given.pme.has_value());
}

// A System's α and grid stay unless a tolerance is said, which chooses them anew.
TEST(OpenMMOverrides, ATolerancePutsTheSystemsAlphaAndGridAside) {
  Scene scene = read_over("tip3p-216", {});
  scene.terms.nonbonded->pme = PmeParameters{.alpha = 3.5, .grid = {20, 21, 24}};
  Scene other = scene;
  apply_overrides(scene, {"forcefield.pme_order=4"});
  EXPECT_EQ(scene.terms.nonbonded->pme->order, 4);
  EXPECT_EQ(scene.terms.nonbonded->pme->alpha, 3.5);
  EXPECT_THAT(scene.terms.nonbonded->pme->grid, ElementsAre(20, 21, 24));
  apply_overrides(other, {"forcefield.ewald_tolerance=1e-5"});
  EXPECT_EQ(other.terms.nonbonded->pme->alpha, 0);
  EXPECT_THAT(other.terms.nonbonded->pme->grid, ElementsAre(0, 0, 0));
}

TEST(OpenMMOverrides, PullsAndRestraintsActBesidesTheSystems) {
  const Scene bare = read_over("tip3p-216", {});
  const Scene held =
      read_over("tip3p-216", {"build.pulls=[[3, 100, 0, 0]]", "build.restraints=[[0, 1, 1, 1, 500]]"});
  const Vectors more = forces_of(held) - forces_of(bare);
  EXPECT_NEAR(more(0, 3), 100, 1e-9);
  EXPECT_GT(more.col(0).norm(), 1);
  EXPECT_EQ((more.colwise().norm().array() > 1e-9).count(), 2);
}

TEST(OpenMMOverrides, PullsChangeInTime) {
  const Scene pulled =
      read_over("tip3p-216", {"build.pulls=[[3, 100, 0, 0]]", "run.pull_factor=[[0, 0], [1, 2]]"});
  EXPECT_EQ(pulled.terms.pull_factor.at(0.5), 1);
  EXPECT_EQ(forces_of(pulled), forces_of(read_over("tip3p-216", {}))) << "the factor is 0 at the start";
  EXPECT_THAT(refuse_over("tip3p-216", "run.pull_factor=[[0, 0], [1, 2]]"),
              one_line_with("run.pull_factor", "with pulls"));
}

TEST(OpenMMOverrides, SteeredAtomsStartWhereTheyAre) {
  const Scene plain = read_over("tip3p-216", {}),
              steered = read_over("tip3p-216", {"build.steered=[[3, 0, 0, 0.01, 500]]"});
  EXPECT_EQ(steered.terms.steered.at(0).from, plain.start.x.col(3));
  EXPECT_EQ(forces_of(steered), forces_of(plain));
}

TEST(OpenMMOverrides, KeysThatCannotActAreRefusedWithTheReason) {
  EXPECT_THAT(refuse_over("tip3p-216", "forcefield.precison=mixed"), one_line_with("precison", "precision"));
  EXPECT_THAT(refuse_over("tip3p-216", "forcefield.pme_order=4"), one_line_with("coulomb = \"pme\""));
  EXPECT_THAT(refuse_over("tip3p-216", "forcefield.cutoff_nm=5"), one_line_with("cutoff_nm", "half the box"));
  EXPECT_THAT(refuse_over("tip3p-216", "build.molecules=5"), one_line_with("molecules"));
  EXPECT_THAT(refuse_over("tip3p-216", "build.pulls=[[9999, 1, 0, 0]]"), one_line_with("pulls"));
  Scene bonds = read_over("tip3p-216", {});
  bonds.terms.nonbonded.reset();
  EXPECT_THROW(apply_overrides(bonds, {"forcefield.precision=mixed"}), InputError);
  EXPECT_THROW(apply_overrides(bonds, {"forcefield.cutoff_nm=0.7"}), InputError);
}

}  // namespace
}  // namespace taut::openmm_overrides_tests
