#pragma once

#include <array>
#include <vector>

#include "base/names.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// What every trajectory file says once.
struct TrajectorySetup {
  const System& sys;  // its bonds are those the tensions are of
  const Names& names;
  double h = 0;    // [ps]
  long every = 1;  // steps from frame to frame
  double t0 = 0;   // of the first frame [ps]
  bool periodic = false;
  std::vector<std::array<int, 2>> further_bonds{};  // to be drawn: springs, and what ties virtual sites
};

// What it says again and again. Positions are written as they are in the state, unwrapped: molecules stay
// whole, and leave the box as they diffuse. The box is the frame's own.
struct Frame {
  long step;
  const State& state;
  const Eigen::VectorXd& tension;  // of each bond, positive where it pulls [kJ/mol/nm]
};

}  // namespace taut
