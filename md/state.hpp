#pragma once

#include "base/vectors.hpp"
#include "md/box.hpp"

namespace taut {

// What changes in every step.
struct State {
  Vectors x;     // position [nm], never wrapped: molecules stay whole
  Vectors v;     // velocity [nm/ps]
  Vectors f;     // all forces, F + C, always evaluated at x [kJ/mol/nm]; C are those of constraints
  double t = 0;  // time [ps]
  Box box;       // the periodic box, or none; a barostat changes it
  Vectors F{};   // the forces but for those of constraints; an integrator sets it beside f
};

}  // namespace taut
