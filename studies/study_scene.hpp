#pragma once

#include "systems/scene.hpp"

namespace taut {

// The scene as studies run it. They compare energies and trajectories, so no thermostat and no barostat acts;
// a rough start is relaxed once, not for every trial. What is changed is said in scene.notes, a line each.
// Throws InputError for a start that cannot be relaxed.
Scene prepared_for_study(Scene scene);

}  // namespace taut
