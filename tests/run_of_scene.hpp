#pragma once

#include "named_scene.hpp"
#include "simulation/simulation.hpp"

namespace taut::tests {

using Overrides = std::vector<std::string>;

inline std::vector<Record> rows_of(const std::string& scene, const Overrides& overrides) {
  std::vector<Record> rows;
  Simulation simulation(scene_of(scene, overrides));
  simulation.run([&](const Record& r) { rows.push_back(r); });
  return rows;
}

inline Summary summary_of(const std::string& scene, const Overrides& overrides) {
  return Simulation(scene_of(scene, overrides)).run({});
}

}  // namespace taut::tests
