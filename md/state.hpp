#pragma once

#include "base/vectors.hpp"
#include "md/box.hpp"

namespace taut {

// What changes every step.
struct State {
  Vectors x;     // position [nm], never wrapped: molecules stay whole
  Vectors v;     // velocity [nm/ps]
  Vectors f;     // force [kJ/mol/nm], always evaluated at x
  double t = 0;  // time [ps]
  Box box;       // what is periodic in it; a barostat changes it
};

}  // namespace taut
