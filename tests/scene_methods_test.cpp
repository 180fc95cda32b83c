// Every method on every scene, through the verifier that looks at every step.

#include <gtest/gtest.h>

#include <map>

#include "constraints/redundancy.hpp"
#include "forcefield/force_field.hpp"
#include "md/units.hpp"
#include "simulation/simulation.hpp"
#include "systems/scene/scene_file.hpp"
#include "verifier.hpp"

namespace taut::scene_methods_tests {
namespace {

using tests::Verdict;
using tests::verify;

struct SceneAndMethod {
  std::string scene, method;
};
void PrintTo(const SceneAndMethod& c, std::ostream* out) {
  *out << c.method << " on " << c.scene;
}

std::vector<SceneAndMethod> all() {
  std::vector<SceneAndMethod> cases;
  for (const auto& summary : list_scenes())
    for (const auto method : method_names()) {
      const bool water = summary.name.starts_with("water") || summary.name.starts_with("spc");
      if (method == "settle" && !water) continue;  // refused: tests/methods_test.cpp
      cases.push_back({summary.name, std::string(method)});
    }
  return cases;
}

// The scene as shipped, but for a step at which every method, penalty springs too, can be judged.
Scene read(const std::string& name) {
  Scene scene = read_scene(find_scene(name));
  scene.run.dt_fs *= 0.5;
  return scene;
}

int steps_for(const Scene& scene) {
  return scene.system.atoms() < 100 ? 400 : 25;
}

class Scenes : public ::testing::TestWithParam<SceneAndMethod> {};

TEST_P(Scenes, HoldTheirBonds) {
  const auto& [name, method] = GetParam();
  const Scene scene = read(name);
  const MethodOptions options = default_options(method);
  const double h = scene.run.h();
  ForceField forces(scene.system, scene.start.box, scene.terms);
  const Verdict verdict = verify(scene.system, forces, options, h, steps_for(scene), scene.start,
                                 [&](State s) { return forces.evaluate_energy(scene.system, s); });

  ASSERT_TRUE(verdict.stats.converged()) << in_words(verdict.stats.failure);
  const double promise = make_method(scene.system, options, h)->promised_error();
  const double rounding = 1e-14 * (1 + scene.start.x.cwiseAbs().maxCoeff() / scene.system.bonds[0].length);
  EXPECT_LE(verdict.bond_error, promise * (1 + 1e-3) + rounding);
  // Who promises no number is held to what a step's truncation feeds it, or to the softness of its springs.
  // Without correction σ₊ − 2σ + σ₋ = ¼h⁴a², or rounding, adds up to n² times that. What LINCS's four terms leave grows
  // with the coupling of its bonds.
  const double steps = steps_for(scene);
  const std::map<std::string, double> left = {
      {"none", 4 * steps * steps * (verdict.fed_error + 1e-15) + verdict.predicted_error},
      {"lincs", (name == "double_pendulum" ? 150 : 20) * verdict.predicted_error}};
  if (const auto at = left.find(method); at != left.end()) {
    EXPECT_LT(verdict.bond_error, at->second + rounding);
  }
  if (method == "penalty") {
    EXPECT_LT(verdict.bond_error, 0.15);
  }
  EXPECT_GT(verdict.turn, 0.8) << "a bond turned over";
  if (scene.closed()) {
    EXPECT_LT(verdict.momentum_change, 1e-12);
  }
  RecordProperty("energy_change", std::to_string(verdict.energy_change));
  const bool exact_velocities = method != "shake" && method != "penalty" && method != "none";
  EXPECT_LT(verdict.energy_change, exact_velocities ? 0.05 : 0.5);
}

INSTANTIATE_TEST_SUITE_P(Every, Scenes, ::testing::ValuesIn(all()),
                         [](const auto& test) { return test.param.scene + "_" + test.param.method; });

TEST(Scenes, AreOfFullRank) {
  for (const auto& summary : list_scenes()) {
    const Scene scene = read_scene(find_scene(summary.name));
    EXPECT_TRUE(find_redundancy(scene.system, scene.start.x).none()) << summary.name;
  }
}

class HardMolecules : public ::testing::TestWithParam<SceneAndMethod> {};

TEST_P(HardMolecules, AreHeldAndKeepTheirEnergy) {
  const auto& [name, method] = GetParam();
  const auto file = scenes_folder() / "hard" / (name + ".toml");
  Simulation simulation(read_scene(file, {"method.name=" + method, "run.steps=3000"}));
  const double energy = simulation.record().total();
  const Summary summary = simulation.run([](const Record&) {});
  EXPECT_NE(summary.converged, false);
  EXPECT_LT(summary.max_rel_bond_error, method == "baumgarte" ? 1e-6 : 2e-10);
  EXPECT_LT(std::abs(summary.total - energy), 0.01 * kBoltzmann * 300 * simulation.dof().total());
}

std::vector<SceneAndMethod> hard_molecules() {
  std::vector<SceneAndMethod> cases;
  for (const char* scene : {"methane", "cholesterol", "heme"})
    for (const char* method : {"newton", "rattle", "feedforward", "baumgarte"})
      cases.push_back({scene, method});
  return cases;
}
INSTANTIATE_TEST_SUITE_P(Each, HardMolecules, ::testing::ValuesIn(hard_molecules()),
                         [](const auto& test) { return test.param.scene + "_" + test.param.method; });

}  // namespace
}  // namespace taut::scene_methods_tests
