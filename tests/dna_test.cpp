// A DNA duplex in vacuum, bonds to hydrogens rigid, at 2 fs: whose the drift is, and what foretells it.

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "foretold.hpp"
#include "openmm_folder.hpp"
#include "simulation/simulation.hpp"
#include "systems/openmm/import.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut::dna_tests {
namespace {

using tests::foretold;
using tests::foretold_by_bond;

Scene dna(std::vector<std::string> settings) {
  const tests::Files files = tests::data("dna-hbonds");
  Scene scene = import_openmm(files.system, files.state);
  settings.insert(settings.begin(), {"run.dt_fs=2", "run.steps=5000", "run.log_every=20", "run.seed=1",
                                     "run.velocities=draw", "run.temperature_k=300"});
  apply_overrides(scene, settings);
  return scene;
}

Summary run_of(const std::vector<std::string>& settings) {
  Simulation simulation(dna(settings));
  return simulation.run({});
}

// Weakly damped, so that what is pumped does not grow into what pumps.
TEST(Dna, TheDriveThroughTheFilterForetellsTheHeat) {
  const double h = 0.002, ah = 0.02, bh_squared = 2;
  double measured = 0, said = 0;
  for (const char* seed : {"run.seed=1", "run.seed=2"}) {
    measured += run_of({"method.name=baumgarte", "method.damping=centred",
                        "method.alpha_per_ps=" + std::to_string(ah / h),
                        "method.beta_per_ps=" + std::to_string(std::sqrt(bh_squared) / h), seed})
                    .constraint_drift.value;
    said += foretold(dna({seed}), {{ah, bh_squared}})(0);
  }
  EXPECT_NEAR(measured / said, 1, 0.15);
}

// It is hydrogens on carbon that swing fast, and amines; hydroxyls turn.
TEST(Dna, TheDriveHeatsMostWhereHydrogensBendFastest) {
  const Scene scene = dna({});
  const System& sys = scene.system;
  const Eigen::VectorXd by_bond = foretold_by_bond(scene, {{0.1, 2}}).col(0);
  std::vector<int> hydrogens(sys.atoms());
  const auto heavy = [&](const RigidBond& b) { return sys.mass[b.i] > sys.mass[b.j] ? b.i : b.j; };
  for (const RigidBond& bond : sys.bonds) ++hydrogens[heavy(bond)];
  std::map<std::pair<long, int>, double> share;  // by the heavy atom's mass and its hydrogens
  for (int k = 0; k < sys.bond_count(); ++k)
    share[{std::lround(sys.mass[heavy(sys.bonds[k])]), hydrogens[heavy(sys.bonds[k])]}] +=
        by_bond[k] / by_bond.sum();
  EXPECT_NEAR((share[{12, 1}]), 0.46, 0.08);  // CH
  EXPECT_NEAR((share[{14, 2}]), 0.24, 0.06);  // NH₂
  EXPECT_NEAR((share[{12, 2}]), 0.21, 0.06);  // CH₂
  EXPECT_LT((share[{16, 1}]), 0.03);          // OH
}

// All bonds rigid, where many meet.
TEST(Dna, OfAllBondsTheDriveHeatsAsForetold) {
  const double h = 0.002, ah = 1, bh_squared = 3;
  Scene rigid = dna({"run.steps=3000", "method.name=baumgarte", "method.damping=centred",
                     "method.alpha_per_ps=" + std::to_string(ah / h),
                     "method.beta_per_ps=" + std::to_string(std::sqrt(bh_squared) / h)});
  std::vector<RigidBond> bonds = rigid.system.bonds;
  for (const HarmonicBond& spring : rigid.terms.bonds) bonds.push_back({spring.i, spring.j, spring.length});
  rigid.terms.bonds.clear();
  rigid.system = make_system(rigid.system.mass, bonds);
  EXPECT_NEAR(Simulation(rigid).run({}).constraint_drift.value / foretold(rigid, {{ah, bh_squared}})(0), 1,
              0.15);
}

TEST(Dna, TheDefaultDriftsByLittleOfCentredDampings) {
  const Summary by_default = run_of({"method.name=baumgarte"});
  const Summary centred = run_of({"method.name=baumgarte", "method.damping=centred"});
  EXPECT_GT(centred.drift.value, 5);
  EXPECT_NEAR(centred.constraint_drift.value / centred.drift.value, 1.1, 0.1);
  EXPECT_LT(std::abs(by_default.drift.value), 0.03 * centred.drift.value);
  EXPECT_LT(by_default.rms_rel_bond_error, 0.1 * centred.rms_rel_bond_error);
  ASSERT_FALSE(centred.doubts.empty());
  EXPECT_NE(centred.doubts[0].find("the constraints heat by"), std::string::npos);
}

}  // namespace
}  // namespace taut::dna_tests
