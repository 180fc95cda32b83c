#pragma once

#include <optional>
#include <span>

#include "base/statistics.hpp"

namespace taut {

// A mean at steps of length h.
struct AtStep {
  double h;
  Estimate mean;
};

// What means at several steps come to at none.
struct ZeroStep {
  Estimate value, slope;  // of y = value + slope·h²
  double chi_square = 0;  // of the points about the line, Σ (deviation/error)²
  int free = 0;           // points less the line's two numbers
  double chance = 1;      // that points on a line lie so far off it, or farther
  bool on_the_line() const { return chance >= 0.01; }
};

// Means under a step that can be reversed in time, as velocity Verlet, are those of a shadow Hamiltonian, even in h:
// y(h) = y₀ + ah² + O(h⁴) (docs/ensembles.md). The line through the points, each weighing 1/error², has at h = 0 y₀,
// where the points lie on it. None for fewer than two lengths of step, or for a point without an error.
std::optional<ZeroStep> at_zero_step(std::span<const AtStep> points);

}  // namespace taut
