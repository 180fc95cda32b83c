#pragma once

#include "md/archive.hpp"
#include "md/step.hpp"

namespace taut {

// The three gaps of the step, empty. A method derives from this and fills those it needs.
struct EmptyGaps {
  // x is drifted by h·v, so x − hv are the positions before. May move x, and v by the same over h.
  SolveStats project_positions(const System&, double, State&) { return {}; }
  // v is the half-step velocity, f the force at x. May add Jᵀλ to f.
  SolveStats add_forces(const System&, double, State&) { return {}; }
  // v is the full-step velocity. May take its part along the bonds out.
  SolveStats project_velocities(const System&, double, State&) { return {}; }
};

}  // namespace taut
