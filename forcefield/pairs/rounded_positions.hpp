#pragma once

#include "base/aligned.hpp"

namespace taut {

// Positions in single precision for pair lists, 16 numbers a cluster, each with a margin: the distance that
// the atom may have from it. A list for a range holds all pairs whose rounded positions are within the range
// plus both margins.
struct RoundedPositions {
  Aligned<float> x;   // 16 a cluster: x of its four, y, z, margin [nm]
  double extent = 0;  // the largest coordinate, periodic shifts included [nm]

  // The range made wide enough for the rounding of coordinates [nm].
  double safely(double range) const { return range * (1 + 1e-5) + extent * 1e-6; }
};

}  // namespace taut
