// A DNA duplex in vacuum, bonds to hydrogens rigid, at 2 fs: whose the drift is, and what foretells it.

#include <gtest/gtest.h>

#include <cmath>

#include "constraints/bond_algebra.hpp"
#include "constraints/direct_solver.hpp"
#include "constraints/feedforward.hpp"
#include "constraints/projection.hpp"
#include "simulation/simulation.hpp"
#include "systems/openmm/openmm_import.hpp"
#include "systems/scene_file.hpp"

namespace taut {
namespace {

Scene dna(std::vector<std::string> settings) {
  const std::string data = std::string(TAUT_TEST_DATA) + "/dna-hbonds.";
  Scene scene = import_openmm(data + "system.xml", data + "state.xml");
  settings.insert(settings.begin(), {"run.dt_fs=2", "run.steps=5000", "run.log_every=20", "run.seed=1",
                                     "run.velocities=draw", "run.temperature_k=300"});
  apply_overrides(scene, settings);
  return scene;
}

Summary run_of(const std::vector<std::string>& settings) {
  Simulation simulation(dna(settings));
  return simulation.run({});
}

// What centred damping's bonds would do to a run that does not heat: σ of the drive ¼h⁴|a|², through the
// law's recurrence, at work Σ ½(λ + λ₊)Δσ + ¼(δλ₊ − δλ)|Δr|², A δλ = (σ₊ − 2σ + σ₋)/h².
double foretold(const Scene& scene, double ah, double bh_squared) {
  const System& sys = scene.system;
  const double h = scene.run.h();
  const int m = sys.bond_count();
  ForceField forces(sys, scene.start.box, scene.terms);
  Feedforward method(sys, {}, h);
  const Dynamics dynamics{sys, forces, method};
  State s = scene.start;
  initialize(dynamics, s);
  DirectSolver solver(sys);
  Vectors r(3, m), r_next(3, m), a = Vectors::Zero(3, sys.atoms()), a_ij(3, m);
  Eigen::VectorXd now = Eigen::VectorXd::Zero(m), before = now, next = now, square_before = now;
  differences(sys, s.x, r);
  double work = 0;
  constexpr long kSettle = 50;
  for (long n = 0; n < scene.run.steps; ++n) {
    a = s.f * sys.inv_mass.asDiagonal();
    differences(sys, a, a_ij);
    const Eigen::VectorXd lambda = method.lambda();
    EXPECT_TRUE(step(dynamics, h, s).converged());
    differences(sys, s.x, r_next);
    const Eigen::VectorXd drive = std::pow(h, 4) / 4 * a_ij.colwise().squaredNorm().transpose();
    next = (drive + (2 - bh_squared) * now - (1 - ah) * before) / (1 + ah);
    Eigen::VectorXd more = (next - 2 * now + before) / (h * h);  // δλ
    solver.factor(r);
    solver.solve(more);
    const Eigen::VectorXd square = (r_next - r).colwise().squaredNorm();
    if (n > kSettle)
      work += 0.5 * (lambda + method.lambda()).dot(next - now) - 0.25 * more.dot(square - square_before);
    square_before = square;
    before = now;
    now = next;
    r = r_next;
  }
  const double ns = static_cast<double>(scene.run.steps - kSettle - 1) * h / 1000;
  return work / ns / degrees_of_freedom(sys, m, true).total();
}

// Weakly damped, so that what is pumped does not grow into what pumps.
TEST(Dna, TheDriveThroughTheFilterForetellsTheHeat) {
  const double h = 0.002, ah = 0.02, bh_squared = 2;
  const Summary summary = run_of({"method.name=baumgarte", "method.damping=centred",
                                  "method.alpha_per_ps=" + std::to_string(ah / h),
                                  "method.beta_per_ps=" + std::to_string(std::sqrt(bh_squared) / h)});
  EXPECT_NEAR(summary.constraint_drift.value / foretold(dna({}), ah, bh_squared), 1, 0.15);
}

// With all bonds rigid, where many meet, what one pass's guess of λ misses takes a quarter of it back: two
// passes, which miss nothing, heat as foretold.
TEST(Dna, OfAllBondsTwoPassesHeatAsForetold) {
  const double h = 0.002, ah = 1, bh_squared = 3;
  Scene rigid = dna({"run.steps=3000", "method.name=baumgarte", "method.damping=centred",
                     "method.alpha_per_ps=" + std::to_string(ah / h),
                     "method.beta_per_ps=" + std::to_string(std::sqrt(bh_squared) / h)});
  std::vector<RigidBond> bonds = rigid.system.bonds;
  for (const HarmonicBond& spring : rigid.terms.bonds) bonds.push_back({spring.i, spring.j, spring.length});
  rigid.terms.bonds.clear();
  rigid.system = make_system(rigid.system.mass, bonds);
  const auto measured = [&](const char* passes) {
    Scene scene = rigid;
    apply_overrides(scene, {passes});
    return Simulation(scene).run({}).constraint_drift.value;
  };
  const double one = measured("method.passes=1"), two = measured("method.passes=2");
  EXPECT_NEAR(two / foretold(rigid, ah, bh_squared), 1, 0.15);
  EXPECT_LT(one, 0.88 * two);
}

TEST(Dna, TheDefaultDriftsByATenthOfCentredDampings) {
  const Summary by_default = run_of({"method.name=baumgarte"});
  const Summary centred = run_of({"method.name=baumgarte", "method.damping=centred"});
  EXPECT_GT(centred.drift.value, 5);
  EXPECT_NEAR(centred.constraint_drift.value / centred.drift.value, 1.1, 0.1);
  EXPECT_LT(std::abs(by_default.drift.value), 0.12 * centred.drift.value);
  EXPECT_LT(by_default.rms_rel_bond_error, 0.1 * centred.rms_rel_bond_error);
  ASSERT_FALSE(centred.doubts.empty());
  EXPECT_NE(centred.doubts[0].find("the constraints heat by"), std::string::npos);
}

}  // namespace
}  // namespace taut
