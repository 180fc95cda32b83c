#pragma once

#include "md/moving_anchors.hpp"
#include "systems/scene/scene.hpp"

namespace taut {

// What cannot hold bonds whose ends are moved is refused by InputError, which names such a bond.

void refuse_method_of_moved_bonds(const System& sys, const MovingAnchors& anchors,
                                  const MethodOptions& options, const ConstraintMethod& method);
void refuse_thermostat_of_moved_bonds(const System& sys, const MovingAnchors& anchors,
                                      const RunSettings& run);

// Sets velocities of anchors that move to 0 where a start has them as their motion does, to as many digits as files have.
void leave_out_prescribed_velocities(const std::vector<AnchorMotion>& motions, MovingAnchors& anchors,
                                     State& s);

}  // namespace taut
