#pragma once

#include "md/bath.hpp"
#include "md/constraint_method.hpp"
#include "md/force_law.hpp"

namespace taut {

// What moves a system: what pulls at its atoms, what holds its bonds, what keeps it warm.
struct Dynamics {
  const System& sys;
  ForceLaw& forces;
  ConstraintMethod& method;
  Bath& bath = no_bath();
};

// One step of velocity Verlet, length h [ps].
SolveStats step(const Dynamics& dynamics, double h, State& s);

// The step's parts: v += (h/2) M⁻¹f and x += hv.
void half_kick(const System& sys, double h, State& s);
void drift(double h, State& s);

}  // namespace taut
