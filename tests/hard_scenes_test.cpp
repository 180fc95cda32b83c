// Molecules on which others fail: what holds them here.

#include <gtest/gtest.h>

#include "md/units.hpp"
#include "simulation/simulation.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut::hard_scenes_tests {
namespace {

struct Case {
  const char *scene, *method;
};
std::ostream& operator<<(std::ostream& out, const Case& of) {
  return out << of.method << " on " << of.scene;
}

class HardMolecules : public ::testing::TestWithParam<Case> {};

TEST_P(HardMolecules, AreHeldAndKeepTheirEnergy) {
  const auto& [name, method] = GetParam();
  const auto file = scenes_folder() / "hard" / (std::string(name) + ".toml");
  Simulation simulation(read_scene(file, {std::string("method.name=") + method, "run.steps=3000"}));
  const double energy = simulation.record().total();
  const Summary summary = simulation.run([](const Record&) {});
  EXPECT_NE(summary.converged, false);
  EXPECT_LT(summary.max_rel_bond_error, std::string(method) == "baumgarte" ? 1e-6 : 2e-10);
  EXPECT_LT(std::abs(summary.total - energy), 0.01 * kBoltzmann * 300 * simulation.dof().total());
}

std::vector<Case> all() {
  std::vector<Case> cases;
  for (const char* scene : {"methane", "cholesterol", "heme"})
    for (const char* method : {"newton", "rattle", "feedforward", "baumgarte"})
      cases.push_back({scene, method});
  return cases;
}
INSTANTIATE_TEST_SUITE_P(Each, HardMolecules, ::testing::ValuesIn(all()), [](const auto& test) {
  return std::string(test.param.scene) + "_" + test.param.method;
});

}  // namespace
}  // namespace taut::hard_scenes_tests
