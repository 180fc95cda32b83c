#pragma once

#include <string>

#include "systems/scene.hpp"

namespace taut {

// Velocities of a scene whose atoms are placed: a start that moves keeps its own, unless run.velocities asks
// for others; drawn at run.temperature_k (Maxwell–Boltzmann; their part along the bonds is taken out later)
// where that asks for it, or where the start is at rest. Called again after other settings, it draws again
// only what it drew. Throws InputError for velocities asked for without a temperature.
void give_velocities(Scene& scene);

// "drawn at 298.15 K", "the start's", "none, at rest"
std::string describe_velocities(const Scene& scene);

}  // namespace taut
