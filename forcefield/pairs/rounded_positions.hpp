#pragma once

#include "base/aligned.hpp"

namespace taut {

// Places good enough for lists, sixteen numbers to a vector, and how far each atom may be from its own: a
// list for a range holds all pairs whose places are within range and both their margins.
struct RoundedPositions {
  Aligned<float> x;   // 16 a cluster: x of its four, y, z, margin [nm]
  double extent = 0;  // the largest of them, and of the shifts they are given [nm]

  // A range that misses none, whatever was rounded [nm].
  double safely(double range) const { return range * (1 + 1e-5) + extent * 1e-6; }
};

}  // namespace taut
