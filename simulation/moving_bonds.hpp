#pragma once

#include "md/moving_anchors.hpp"
#include "systems/scene/scene.hpp"

namespace taut {

// What cannot hold bonds whose ends are moved is refused by InputError, which names such a bond.

void refuse_method_of_moved_bonds(const System& sys, const MovingAnchors& anchors,
                                  const MethodOptions& options, const ConstraintMethod& method);
void refuse_thermostat_of_moved_bonds(const System& sys, const MovingAnchors& anchors,
                                      const RunSettings& run);

}  // namespace taut
