#pragma once

#include <string_view>
#include <vector>

#include "systems/builders/biases.hpp"

namespace taut {

inline constexpr std::string_view kLogSteeringWork = "Steering Work (kJ/mole)";

// The columns that walls, steered atoms, pulls that change in time and biases add to a scene's log, in their order.
std::vector<LogColumn> further_columns(const Scene& scene);

}  // namespace taut
