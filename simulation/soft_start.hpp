#pragma once

#include "simulation/minimise.hpp"
#include "systems/scene/scene.hpp"

namespace taut {

// For starts whose atoms overlap: pushes them apart by forces that stay finite where two atoms are in one place, in
// place of the scene's pair forces. Pairs repel by the energy
//     E = A(1 + cos(πr/r_c)),   r < r_c = 2^(1/6)(σ_i + σ_j)/2,
// whose largest force is πA/r_c, which acts below r_c/10, too; all other forces act as they are. Steepest descent on
// the bonds, as run.minimise. Two atoms in one place are told apart by a push of their own along a direction that their
// numbers give.
// Returns the number of moves. Throws as minimise() does.
int push_apart(const Scene& scene, State& s, const OnMove& on_move = {});

}  // namespace taut
