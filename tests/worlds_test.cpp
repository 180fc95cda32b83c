// The examples of systems/worlds, each with what it is there to show.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "constraints/redundancy.hpp"
#include "md/errors.hpp"
#include "simulation/simulation.hpp"
#include "studies/calibration.hpp"
#include "systems/openmm/openmm_export.hpp"
#include "systems/scene_file.hpp"

namespace taut {
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
  double worst = 0;   // relative bond error
  double energy = 0;  // of the swing above the knee at rest, so far lost
  bool ends = false;
};
Swing minute_of_swinging(const Overrides& overrides) {
  Swing swing;
  double first = 0;
  swing.ends = watch(read_scene(world("knee"), overrides), [&](const Simulation& s) {
    const Record r = s.record();
    if (s.step() == 0) first = r.total();
    swing.energy = r.total() - first;
    swing.worst = std::max(swing.worst, r.bonds.max);
  });
  return swing;
}

// β = √(k/I), k of the spring at its lever about where the ligaments cross, I of the leg: what a joint's own
// stiffness suggests is a hundredth of what the step bears.
TEST(Knee, LigamentsHoldByCalibratedGainsAndDriftByPhysicalOnes) {
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

  const Swing calibrated = minute_of_swinging({});
  EXPECT_TRUE(calibrated.ends);
  EXPECT_LT(calibrated.worst, 2e-7);
  EXPECT_LT(std::abs(calibrated.energy), 5e-4);
  const Swing physical = minute_of_swinging({"method.alpha_per_ps=4.14", "method.beta_per_ps=4.14"});
  EXPECT_TRUE(physical.ends);
  EXPECT_GT(physical.worst, 3e-4);
  EXPECT_LT(physical.worst, 2e-3);
  EXPECT_NEAR(physical.energy, -0.1, 0.04);  // of 0.5·2.5·1² J
  EXPECT_FALSE(minute_of_swinging({"method.name=none"}).ends);
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
    EXPECT_NEAR(off(s), foretold[n], 0.02 * std::abs(foretold[n]) + 1e-7) << n;
    ++n;
  });
  EXPECT_GT(std::abs(foretold.back()), 1e-5);
  n = 0;
  watch(read_scene(world("planted_foot")), [&](const Simulation& s) {
    EXPECT_LT(std::abs(off(s)), 5e-7);
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
  EXPECT_LT(nearest_layers(without), 0);
  EXPECT_LT(nearest_layers(read_scene(world("fold"), {"method.name=none"})), 0.5);
  EXPECT_GT(nearest_layers(scene), 1 - 1e-9);
  EXPECT_GT(nearest_layers(read_scene(world("fold"), {"method.name=rattle"})), 1 - 1e-9);
  EXPECT_GT(nearest_layers(read_scene(world("fold"), {"method.name=baumgarte"})), 1 - 1e-3);
}

// To the last bit, in the middle of touches.
TEST(Fold, GoesOnWhereItStopped) {
  for (const std::string method : {"newton", "rattle", "baumgarte"}) {
    Overrides overrides = {"method.name=" + method, "run.steps=450"};
    if (method == "rattle") overrides.push_back("method.max_sweeps=20000");
    Simulation whole(read_scene(world("fold"), overrides));
    std::string kept;
    bool acts = false;
    whole.run([](const Record&) {},
              [&](long step) {
                if (step != 400) return;
                acts = whole.method().lambda().tail(15).any();
                Archive archive = Archive::saving_to(kept);
                whole.serialize(archive);
              });
    EXPECT_TRUE(acts) << method;
    Simulation resumed(read_scene(world("fold"), overrides));
    resumed.restore(kept);
    resumed.run([](const Record&) {});
    EXPECT_EQ(resumed.state().x, whole.state().x) << method;
    EXPECT_EQ(resumed.state().v, whole.state().v) << method;
  }
}

TEST(Fold, WhatKnowsNoStrutsSaysSo) {
  const auto words = [](auto&& action) -> std::string {
    try {
      action();
    } catch (const InputError& e) {
      return e.what();
    }
    return "done";
  };
  const Scene scene = read_scene(world("fold"));
  EXPECT_THAT(words([&] {
                openmm_system_xml({scene.system, scene.terms, scene.start});
              }),
              HasSubstr("OpenMM cannot express it: one-sided bond 0 (0-10)"));
  EXPECT_THAT(words([&] { calibrate(scene, {}); }), HasSubstr("has one-sided bonds (at_least, at_most)"));
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
}  // namespace taut
