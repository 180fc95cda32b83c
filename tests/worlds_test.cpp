// The examples of systems/worlds, each with what it is there to show.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "base/errors.hpp"
#include "constraints/redundancy.hpp"
#include "error_message.hpp"
#include "forcefield/external.hpp"
#include "kept_state.hpp"
#include "md/observables.hpp"
#include "md/units.hpp"
#include "simulation/simulation.hpp"
#include "studies/calibration.hpp"
#include "systems/openmm/export.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut::worlds_tests {
namespace {

using Overrides = std::vector<std::string>;
using ::testing::HasSubstr;

std::filesystem::path world(const std::string& name) {
  return scenes_folder() / "worlds" / (name + ".toml");
}

// Every step looked at; whether it ran to its end.
bool watch(Scene scene, auto&& look) {
  Simulation simulation(std::move(scene));
  look(simulation);
  try {
    simulation.run([](const Record&) {}, [&](long) { look(simulation); });
  } catch (const SimulationFailure&) {
    return false;
  }
  return true;
}

struct Swing {
  double ligaments = 0;  // off by at most [mm]
  double bonds = 0;      // all, relative
  double energy = 0;     // given in all [J]
  double ended = 0;      // [s]
  bool ends = false;
};
Swing minute_of_swinging(Overrides overrides, double dt_ms = 1) {
  overrides.push_back(fmt::format("run.dt_fs={}", dt_ms));
  overrides.push_back(fmt::format("run.steps={}", static_cast<long>(60000 / dt_ms)));
  overrides.push_back("run.log_every=60000");
  Swing swing;
  double first = 0;
  swing.ends = watch(read_scene(world("knee"), overrides), [&](const Simulation& s) {
    const Vectors& x = s.state().x;
    for (const RigidBond& bond : {s.scene().system.bonds[3], s.scene().system.bonds[4]})
      swing.ligaments =
          std::max(swing.ligaments, 1e3 * std::abs((x.col(bond.j) - x.col(bond.i)).norm() - bond.length));
    swing.bonds = std::max(swing.bonds, bond_errors(s.scene().system, x).max);
    if (s.step() == 0) first = s.record().total();
    if (s.step() == s.scene().run.steps) swing.energy = s.record().total() - first;
    swing.ended = s.state().t;
  });
  return swing;
}

// β = √(k/I), k of the spring at its lever about where the ligaments cross, I of the leg: what a joint's own
// stiffness suggests is a hundredth of what the step bears.
TEST(Knee, LigamentsHoldByAllGainsAndDriftWithoutAny) {
  const Scene scene = read_scene(world("knee"));
  const Vectors& x = scene.start.x;
  const auto cross = [](const Vec3& a, const Vec3& b) { return a.x() * b.y() - a.y() * b.x(); };
  const Vec3 acl = x.col(3) - x.col(1), pcl = x.col(4) - x.col(2);
  const double along = cross(x.col(2) - x.col(1), pcl) / cross(acl, pcl);
  const Vec3 crossing = x.col(1) + along * acl;
  double inertia = 0;
  for (const int a : {3, 4, 5}) inertia += scene.system.mass[a] * (x.col(a) - crossing).squaredNorm();
  const Vec3 spring = x.col(5) - x.col(6);
  const double lever = cross(crossing - x.col(6), spring) / spring.norm();
  EXPECT_NEAR(std::sqrt(scene.terms.bonds[0].k * lever * lever / inertia), 4.14, 0.01);

  const Overrides physical = {"method.alpha_per_ps=4.14", "method.beta_per_ps=4.14"};
  const Swing held = minute_of_swinging({}), soft = minute_of_swinging(physical);
  EXPECT_TRUE(held.ends && soft.ends);
  EXPECT_LT(held.ligaments, 2e-10);
  EXPECT_NEAR(held.energy, -6.76e-5, 7e-7);  // of 0.5·2.5·1² J
  EXPECT_LT(soft.ligaments, 2e-8);
  EXPECT_NEAR(soft.energy, -6.76e-5, 7e-7);
  const Swing drifting = minute_of_swinging({"method.name=none"});
  EXPECT_NEAR(drifting.ligaments, 9.06, 0.1);
  EXPECT_GT(drifting.energy, 1);

  for (const Overrides& gains : {Overrides{}, physical}) EXPECT_LT(minute_of_swinging(gains, 27).bonds, 0.01);
}

// σ₊ − 2σ + σ₋ = ¼h⁴|a|², σ₁ = ½h³v·a + ⅛h⁴|a|², with v and a of a motion that holds the leg's length.
TEST(PlantedFoot, SlidesAsForetoldUnlessItIsHeld) {
  const double g = 9.81, mass = 70;
  double sigma = 0, before = 0;
  std::vector<double> foretold, closed;
  watch(read_scene(world("planted_foot"), {"method.name=newton"}), [&](const Simulation& s) {
    const double h = s.scene().run.h();
    const Vec3 r = s.state().x.col(1), v = s.state().v.col(1), gravity(0, -g, 0);
    const Vec3 a = gravity - (r.dot(gravity) + v.squaredNorm()) / r.squaredNorm() * r;
    closed.push_back(mass * (g * r.y() - v.squaredNorm()) / r.norm());
    foretold.push_back(sigma / 0.9);
    const double fed = 0.25 * std::pow(h, 4) * a.squaredNorm();
    const double next =
        foretold.size() == 1 ? 0.5 * std::pow(h, 3) * v.dot(a) + 0.5 * fed : 2 * sigma - before + fed;
    before = std::exchange(sigma, next);
  });
  const auto off = [](const Simulation& s) { return s.state().x.col(1).norm() - 0.9; };
  std::size_t n = 0;
  watch(read_scene(world("planted_foot"), {"method.name=none"}), [&](const Simulation& s) {
    EXPECT_NEAR(off(s), foretold[n], 1e-4 * std::abs(foretold[n])) << n;
    ++n;
  });
  EXPECT_GT(std::abs(foretold.back()), 1e-5);
  n = 0;
  watch(read_scene(world("planted_foot")), [&](const Simulation& s) {
    EXPECT_LT(std::abs(off(s)), n < 20 ? 2.6e-7 : 1e-9) << n;
    EXPECT_NEAR(-s.bond_tensions()[0], closed[n], 1e-3 * closed[n]);  // of the ground, upwards along the leg
    EXPECT_GT(closed[n++], 0);                                        // or else the foot would lift
  });
}

double nearest_layers(Scene scene) {
  double nearest = 1e9;
  const std::vector<OneSidedBond> struts = read_scene(world("fold")).system.one_sided;
  watch(std::move(scene), [&](const Simulation& s) {
    for (const OneSidedBond& strut : struts) {
      const Vec3 r = s.state().x.col(strut.j) - s.state().x.col(strut.i);
      nearest = std::min(nearest, (r.x() < 0 ? -1 : 1) * r.norm() / strut.length);
    }
  });
  return nearest;
}

TEST(Fold, StrutsKeepItsLayersApart) {
  const Scene scene = read_scene(world("fold"));
  EXPECT_EQ(find_redundancy(scene.system, scene.start.x).rank(scene.system), 56);
  EXPECT_EQ(scene.system.one_sided.size(), 15u);
  Scene without = scene;
  without.system.one_sided.clear();
  without.method = default_options("newton");
  EXPECT_LT(nearest_layers(without), 0);
  EXPECT_LT(nearest_layers(read_scene(world("fold"), {"method.name=none"})), 0.5);
  EXPECT_GT(nearest_layers(scene), 1 - 1e-9);
  EXPECT_GT(nearest_layers(read_scene(world("fold"), {"method.name=shake", "method.max_sweeps=20000"})),
            1 - 1e-9);
  EXPECT_GT(nearest_layers(read_scene(world("fold"), {"method.name=baumgarte"})), 1 - 1e-3);
}

// What struts take when they stop is all that the fold loses, and it ends where the load is held.
TEST(Fold, ComesToRestFolded) {
  double kinetic = 0, most = 0;
  watch(read_scene(world("fold")), [&](const Simulation& s) {
    kinetic = s.record().kinetic;
    most = std::max(most, kinetic);
  });
  EXPECT_LT(kinetic, 1e-3 * most);
}

// To the last bit, in the middle of touches.
TEST(Fold, GoesOnWhereItStopped) {
  for (const std::string method : {"rattle", "baumgarte"}) {
    Overrides overrides = {"method.name=" + method, "run.steps=450"};
    if (method == "rattle") overrides.push_back("method.max_sweeps=20000");
    Simulation whole(read_scene(world("fold"), overrides)), resumed(read_scene(world("fold"), overrides));
    std::string there;
    bool acts = false;
    whole.run({}, [&](long step) {
      if (step != 400) return;
      acts = whole.method().lambda().tail(15).any();
      there = kept(whole);
    });
    EXPECT_TRUE(acts) << method;
    resumed.restore(there);
    resumed.run({});
    EXPECT_EQ(resumed.state().x, whole.state().x) << method;
    EXPECT_EQ(resumed.state().v, whole.state().v) << method;
  }
}

TEST(Fold, WhatKnowsNoStrutsSaysSo) {
  const Scene scene = read_scene(world("fold"));
  EXPECT_THAT(error_message([&] {
                openmm_system_xml({scene.system, scene.terms, scene.start});
              }),
              HasSubstr("OpenMM cannot express it: one-sided bond 0 (0-10)"));
  EXPECT_THAT(error_message([&] { calibrate(scene, {}); }),
              HasSubstr("has one-sided bonds (at_least, at_most)"));
}

// Both walls bear the pressure of the chains, and by the virial theorem what atoms and bonds give across the slit is
// what the walls take up: ⟨2K_z + Σ z F_z⟩ = 0 of all forces.
TEST(Slit, BothWallsBearThePressureAcrossIt) {
  const Scene scene = read_scene(world("slit"), {"run.steps=10000", "run.seed=3"});
  Simulation simulation(scene);
  RunningMean inside, walls;
  const Summary summary = simulation.run([&](const Record& r) {
    const Vectors& x = simulation.state().x;
    Vectors f = Vectors::Zero(3, x.cols());
    double push = 0;
    for (const Wall& wall : scene.terms.walls) add_wall(wall, x, f, push);
    inside.add(r.pressure_tensor(2, 2) * r.volume / kBarPerUnit);
    walls.add(-(x.row(2).array() * f.row(2).array()).sum());
    EXPECT_GT(x.row(2).minCoeff(), 0);
    EXPECT_LT(x.row(2).maxCoeff(), 4);
  });
  ASSERT_EQ(summary.walls.size(), 2u);
  EXPECT_GT(summary.walls[0].value, 100);  // bar
  EXPECT_LT(deviations(summary.walls[0], summary.walls[1]), 4);
  EXPECT_NEAR(inside.estimate().value, walls.estimate().value, 0.05 * walls.estimate().value);
}

// systems/README.md shows every scene, with a picture that is there.
TEST(Gallery, HasEveryScene) {
  const auto folder = scenes_folder();
  std::ostringstream text;
  text << std::ifstream(folder / "README.md").rdbuf();
  for (const char* in : {"", "hard", "worlds"})
    for (const auto& scene : list_scenes(folder / in)) {
      EXPECT_THAT(text.str(), HasSubstr("`" + scene.name + "`"));
      EXPECT_THAT(text.str(), HasSubstr("(gallery/" + scene.name + ".png)"));
      EXPECT_TRUE(std::filesystem::exists(folder / "gallery" / (scene.name + ".png"))) << scene.name;
    }
}

}  // namespace
}  // namespace taut::worlds_tests
