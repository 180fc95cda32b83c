#pragma once

#include "forcefield/clusters/aligned.hpp"

namespace taut {

// Positions good enough for lists: sixteen fit a vector.
struct RoundedPositions {
  Aligned<float> x;   // 12 a cluster: x of its four, y, z [nm]
  double extent = 0;  // the largest of them, and of the shifts they are given [nm]

  // A range that misses none, whatever was rounded [nm].
  double safely(double range) const { return range * (1 + 1e-5) + extent * 1e-6; }
};

}  // namespace taut
