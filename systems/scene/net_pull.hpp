#pragma once

#include <string>

#include "systems/scene/scene.hpp"

namespace taut {

// Returns a message if pulls accelerate their molecules as a whole, so that they move off ever faster: where the
// forces on all molecules that nothing holds do not add up to zero. Anchors, restraints and steered atoms hold a
// molecule, walls hold it along their axes. Empty if the forces add up, or if the scene removes the momentum.
std::string net_pull_message(const Scene& scene);

}  // namespace taut
