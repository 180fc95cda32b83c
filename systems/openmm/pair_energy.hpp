#pragma once

#include <functional>
#include <optional>

#include "systems/openmm/expression.hpp"

namespace taut {

// The energy of two atoms that taut's kernels compute, a/r¹² − b/r⁶ + q/r + k r² + e, with the numbers found in a
// formula of whatever spelling.
struct PairEnergy {
  double a, b, q, k, e;

  // Finds them in an energy of the distance, which is looked at up to the reach alone; nothing where it is another
  // one. What adds less than 1e-11 from a tenth of the reach on is rounding error, and becomes 0.
  static std::optional<PairEnergy> of(const std::function<double(double)>& energy,
                                      std::optional<double> reach);
  // Its value, and what that is uncertain by.
  Expression::Rough at(double r) const;
};

}  // namespace taut
