#pragma once

#include "md/bath.hpp"
#include "md/constraint_method.hpp"
#include "md/force_law.hpp"

namespace taut {

// What moves a system: forces, the method that holds its bonds, thermostat and barostat.
struct Dynamics {
  const System& sys;
  ForceLaw& forces;
  ConstraintMethod& method;
  Bath& bath = no_bath();
};

// One step of velocity Verlet, length h [ps].
SolveStats step(const Dynamics& dynamics, double h, State& s);

// The step's parts: v += (h/2) M⁻¹f, after a bath's ½Δ where there is one; and the same with ½Δ after the
// kick, then x += hv.
void half_kick(const System& sys, double h, const Vectors* jump, State& s);
void half_kick_and_drift(const System& sys, double h, const Vectors* jump, State& s);

}  // namespace taut
