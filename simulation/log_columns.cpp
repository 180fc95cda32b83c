#include "simulation/log_columns.hpp"

#include <fmt/format.h>

namespace taut {

std::vector<LogColumn> further_columns(const Scene& scene) {
  std::vector<LogColumn> columns;
  const bool in_box = scene.start.box.periodic();
  for (std::size_t w = 0; w < scene.terms.walls.size(); ++w)
    columns.push_back(in_box ? LogColumn{fmt::format("Wall {} Pressure (bar)", w),
                                         fmt::format("wall_{}_pressure_bar", w),
                                         fmt::format("pressure on wall {}", w), "bar"}
                             : LogColumn{fmt::format("Wall {} Force (kJ/mole/nm)", w),
                                         fmt::format("wall_{}_force_kj_mol_nm", w),
                                         fmt::format("force on wall {}", w), "kJ/mol/nm"});
  if (scene.terms.worked_in_time())
    columns.push_back({std::string(kLogSteeringWork), "steering_work_kj_mol", "steering work", "kJ/mol"});
  if (scene.terms.steered_in_time())
    columns.push_back(
        {"Steering Force (kJ/mole/nm)", "steering_force_kj_mol_nm", "steering force", "kJ/mol/nm"});
  for (const Bias& bias : scene.terms.biases)
    for (const LogColumn& column : columns_of(bias)) columns.push_back(column);
  return columns;
}

}  // namespace taut
