#pragma once

#include <bit>
#include <cstdint>

#include "forcefield/clusters/aligned.hpp"

namespace taut {

// Positions as whole multiples of a unit of length, in 32 bits: differences are exact however large the box
// is, and sixteen fit a vector.
struct FixedPositions {
  Aligned<std::int32_t> x;  // 12 a cluster: x of its four, y, z [unit]
  double unit = 1;          // [nm]

  // The nearest whole number, for |u| < 2⁵¹, modulo 2³².
  static std::int32_t fixed(double u) {
    return static_cast<std::int32_t>(std::bit_cast<std::int64_t>(u + 6755399441055744.0));
  }

  // A range that misses none, whatever was rounded [nm].
  double safely(double range) const { return range * (1 + 1e-5) + 4 * unit; }
};

}  // namespace taut
