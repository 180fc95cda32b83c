#pragma once

#include <array>
#include <vector>

#include "base/names.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// Facts that a trajectory file holds once.
struct TrajectorySetup {
  const System& sys;  // the tensions are those of its bonds
  const Names& names;
  double h = 0;    // [ps]
  long every = 1;  // steps between frames
  double t0 = 0;   // time of the first frame [ps]
  bool periodic = false;
  std::vector<std::array<int, 2>> further_bonds{};  // drawn as bonds: springs, and virtual sites to a parent
};

// Facts that a trajectory file holds for each frame. Positions are written unwrapped, as they are in the
// state: molecules stay whole, and leave the box as they diffuse. Each frame has its own box.
struct Frame {
  long step;
  const State& state;
  const Eigen::VectorXd& tension;  // of each bond, positive if it pulls its atoms together [kJ/mol/nm]
};

}  // namespace taut
