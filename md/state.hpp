#pragma once

#include "base/vectors.hpp"
#include "md/box.hpp"

namespace taut {

// What changes in every step.
struct State {
  Vectors x;     // position [nm], never wrapped: molecules stay whole
  Vectors v;     // velocity [nm/ps]
  Vectors f;     // force [kJ/mol/nm], always evaluated at x
  double t = 0;  // time [ps]
  Box box;       // the periodic box, or none; a barostat changes it
};

}  // namespace taut
