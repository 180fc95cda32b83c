// Scenes against what is known of them in closed form. More such cases, which other engines run, too, are in conformance.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/statistics.hpp"
#include "constraints/bond_algebra.hpp"
#include "constraints/methods/newton.hpp"
#include "constraints/projection.hpp"
#include "error_message.hpp"
#include "forcefield/force_field.hpp"
#include "named_scene.hpp"
#include "simulation/simulation.hpp"
#include "verifier.hpp"

namespace taut::closed_forms_tests {
namespace {

std::string method_is(std::string_view method) {
  return "method.name=" + std::string(method);
}

// Of a pendulum: m(|v|² + g·r) d/|r|², at its frame's x and v, from the start on, whatever a method keeps.
TEST(BondTensions, AreOfTheFrameUnderEveryMethod) {
  for (const MethodEntry& method : methods()) {
    const std::string_view name = method.name;
    if (method.added || name == "settle" || name == "penalty")
      continue;  // no water; springs pull by their length
    SCOPED_TRACE(name);
    Simulation pendulum(scene_of("pendulum", {method_is(name), "run.steps=40", "run.dt_fs=2"}));
    const System& sys = pendulum.scene().system;
    const auto& [i, j, d] = sys.bonds[0];
    const Vec3 g = *pendulum.scene().terms.gravity;
    const auto closed_form = [&, i = i, j = j, d = d] {
      const Vec3 r = pendulum.state().x.col(j) - pendulum.state().x.col(i), v = pendulum.state().v.col(j);
      return sys.mass[j] * (v.squaredNorm() + g.dot(r)) * d / r.squaredNorm();
    };
    EXPECT_NEAR(pendulum.bond_tensions()[0], closed_form(), 1e-10);
    pendulum.run({},
                 [&](long step) { EXPECT_NEAR(pendulum.bond_tensions()[0], closed_form(), 1e-10) << step; });
    EXPECT_GT(pendulum.bond_tensions()[0], 0.5);
  }
}

// Measuring them leaves no trace in the run.
TEST(BondTensions, DoNotDisturbTheRun) {
  const std::vector<std::string> keys = {"build.molecules=64", "forcefield.cutoff_nm=0.5", "run.steps=30"};
  Simulation watched(scene_of("water", keys)), alone(scene_of("water", keys));
  watched.run({}, [&](long) { EXPECT_TRUE(watched.bond_tensions().allFinite()); });
  alone.run({});
  EXPECT_EQ(watched.state().x, alone.state().x);
  EXPECT_EQ(watched.state().v, alone.state().v);
}

TEST(Anchors, DoNotMoveWithTheVelocityTheyCameWith) {
  Scene scene = scene_of("pendulum", {"run.steps=20"});
  scene.start.v.col(0) << 1, 2, 3;
  Simulation pendulum(scene);
  pendulum.run({});
  EXPECT_EQ(pendulum.state().x.col(0), scene.start.x.col(0));
  const auto& notes = pendulum.scene().notes;
  EXPECT_TRUE(std::ranges::any_of(notes, [](const std::string& note) {
    return note.find("atom 0 is anchored (mass 0): the velocity it had was left out") != note.npos;
  }));
}

TEST(Anchors, WithThemNoMomentumIsThereToRemove) {
  for (const char* thermostat : {"none", "langevin"})
    EXPECT_THAT(error_message([&] {
                  Simulation(scene_of("pendulum", {"run.remove_momentum_every=10", "run.temperature_k=300",
                                                   std::string("run.thermostat=") + thermostat}));
                }),
                testing::HasSubstr("(run.remove_momentum_every = 10, OpenMM's CMMotionRemover), but bond 0 "
                                   "(0-1) ends in an anchor"));
}

// With σ̈ = 0 alone each step of a rotor leaves θ⁴/8, θ = ωh, which nothing brings back: δd/d = (ωh)²(ωt)²/8.
TEST(None, LetsARotorsBondGrowAsTimeSquaredStepSquared) {
  for (const auto& [dt_fs, steps] : {std::pair{1, 200}, std::pair{1, 400}, std::pair{2, 200}}) {
    Simulation rotor(scene_of("diatomic", {method_is("none"), "run.dt_fs=" + std::to_string(dt_fs),
                                           "run.steps=" + std::to_string(steps)}));
    rotor.run({});
    const double theta = 10 * 1e-3 * dt_fs, turned = theta * steps,
                 growth = theta * theta * turned * turned / 8;
    const Vectors& x = rotor.state().x;
    EXPECT_NEAR((x.col(1) - x.col(0)).norm() - 1, growth, 0.02 * growth) << dt_fs << " fs, " << steps;
  }
}

// The log's drift and the summary's means beside those of the rows, taken plainly. The centred law drifts by 1e-4: a slope of
// totals, whose rounding is 1e-8 of that.
TEST(Log, IsSummedAsItsRowsAre) {
  Simulation simulation(scene_of("trimer", {method_is("baumgarte"), "method.damping=centred", "run.dt_fs=2",
                                            "run.steps=400", "run.log_every=40"}));
  Slope energy;
  double temperatures = 0, squares = 0, largest = 0, rows = 0, drift = 0;
  const Summary summary = simulation.run([&](const Record& r) {
    energy.add(r.t, r.total());
    temperatures += r.temperature;
    squares += r.bonds.rms * r.bonds.rms;
    largest = std::max(largest, r.bonds.max);
    ++rows;
    drift = 1000 * energy.value() / simulation.dof().total();  // per ps to per ns
    EXPECT_NEAR(r.drift, drift, 1e-7 * std::abs(drift));
  });
  EXPECT_EQ(rows, 11);
  EXPECT_NE(drift, 0);
  EXPECT_NEAR(summary.drift.value, drift, 1e-7 * std::abs(drift));
  EXPECT_NEAR(summary.temperature, temperatures / rows, 1e-12 * temperatures);
  EXPECT_NEAR(summary.rms_rel_bond_error, std::sqrt(squares / rows), 1e-12 * std::sqrt(squares));
  EXPECT_EQ(summary.max_rel_bond_error, largest);
}

// Edges, both diagonals of each face and one of the body, 25 bonds on 8 atoms: refused, or 18 are held, and all 25 keep
// their lengths and share the load.
TEST(Redundant, ACubeWithItsDiagonalsRunsOnRequest) {
  Scene cube;
  cube.name = "cube";
  cube.start.x.resize(3, 8);
  for (int n = 0; n < 8; ++n) cube.start.x.col(n) << 0.2 * (n >> 2 & 1), 0.2 * (n >> 1 & 1), 0.2 * (n & 1);
  std::vector<RigidBond> bonds;
  for (int i = 0; i < 8; ++i)
    for (int j = i + 1; j < 8; ++j)
      if (const double d = (cube.start.x.col(j) - cube.start.x.col(i)).norm(); d < 0.29 || i == 0)
        bonds.push_back({i, j, d});
  cube.start.v = Vectors::Zero(3, 8);
  cube.start.v.row(1) = 5 * cube.start.x.row(0);
  cube.start.v.row(2) = -3 * cube.start.x.row(1);
  cube.system = make_system(Eigen::VectorXd::LinSpaced(8, 10, 17), bonds);
  cube.run.steps = 500;
  EXPECT_THROW(Simulation{cube}, InputError);
  cube.run.redundant = "drop";
  for (const char* method : {"rattle", "newton", "feedforward"}) {
    cube.method = default_options(method);
    Simulation simulation(cube);
    EXPECT_EQ(simulation.dof().rank, 18);
    simulation.run({});
    EXPECT_LT(bond_errors(cube.system, simulation.state().x).max, 1e-9) << method;
    EXPECT_GT(simulation.bond_tensions().cwiseAbs().minCoeff(), 0);
    EXPECT_THAT(simulation.scene().notes,
                ::testing::Contains("7 bonds are left out that follow from others"));
  }
  cube.system.bonds.back().length *= 1.01;  // one edge that the others contradict
  const Simulation contradicted(cube);
  EXPECT_THAT(contradicted.scene().notes,
              ::testing::Contains(::testing::HasSubstr("nm; the bonds it follows from make it 0.")));
}

}  // namespace
}  // namespace taut::closed_forms_tests
