#pragma once

#include "md/rigid_motions.hpp"
#include "systems/scene/scene.hpp"

namespace taut {

// The motions whose momenta are held at zero from here on: those of the whole where its momentum is taken out, and
// those whose momenta are conserved and have none, as after a start from rest. A thermostat that rescales keeps
// momenta at zero, Langevin's does not.
RigidMotions::Which fixed_motions(const Scene& scene, const Vectors& x, const Vectors& v);

// Whether momentum is to be taken out that anchors or forces from outside give back at once. The centre is held then:
// between removals it would be neither at rest nor as warm as the bath.
bool holds_centre(const Scene& scene);

// Throws InputError where a bond ends in an anchor: taking the momentum from the atoms it holds would push them along
// their bonds.
void refuse_momentum_of_anchored_bonds(const Scene& scene);

}  // namespace taut
