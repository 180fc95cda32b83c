#pragma once

#include <string>

#include "systems/scene/scene.hpp"

namespace taut {

// A line about the fastest spring of a scene, where its ωh at the scene's step is above 1.5; empty: there is none.
// Velocity Verlet fails from ωh = 2 on; at 1.5 its own frequency is a tenth too high and a full step's temperature
// less than half of the drift's (docs/ensembles.md). Springs are harmonic bonds and angles, each by itself: with the
// gradient g of its length or angle ω² = k gᵀPM⁻¹g, P what the rigid bonds between its atoms leave free. Of bonds that a
// method holds by springs (`bonds_are_springs`) nothing is left out, and their own stiffness is the method's to judge.
//
// Also about the fastest motion of anchors that turns or shakes with Ωh above 1: a step accelerates what is bonded to it by
// 2(1 − cos Ωh)/(Ωh)² of what is right.
std::string unresolved_motion(const Scene& scene, const Vectors& x, bool bonds_are_springs = false);

}  // namespace taut
