#pragma once

#include "systems/scene/scene.hpp"

namespace taut {

// The scene as studies run it. They compare energies and trajectories, so no thermostat and no barostat acts;
// a rough start is relaxed once, not for every trial. What is changed is said in scene.notes, a line each.
// Throws InputError for a start that cannot be relaxed.
Scene prepared_for_study(Scene scene);

// Throws InputError for a key among `overrides` that a study sets itself: it would have no effect.
void refuse_without_effect(const char* study, const std::vector<std::string>& overrides);

}  // namespace taut
