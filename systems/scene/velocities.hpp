#pragma once

#include <string>

#include "systems/scene/scene.hpp"

namespace taut {

// Sets the velocities of a scene whose atoms are placed. They are drawn at run.temperature_k
// (Maxwell–Boltzmann; the part along the bonds is removed later) if run.velocities is "draw" or the start is
// at rest; otherwise the start's are kept. A second call, after settings have changed, replaces only
// velocities that were drawn. Throws InputError if velocities are to be drawn without a temperature.
void give_velocities(Scene& scene);

// Returns "drawn at 298.15 K", "the start's" or "none, at rest".
std::string describe_velocities(const Scene& scene);

}  // namespace taut
