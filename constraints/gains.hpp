#pragma once

#include <optional>
#include <string>

namespace taut {

// σ̈ + 2ασ̇ + β²σ = 0
struct Gains {
  double alpha = 0;  // [1/ps]
  double beta = 0;   // [1/ps]
};

// Gains by name, for a step h [ps], implicit damping (the step's trace is (2−β²h²)/(1+αh), its determinant
// (1−αh)/(1+αh); both derived in DESIGN's section 5 and pinned by tests/baumgarte_test.cpp):
//   "critical"    α = β = 1/h
//   "dead-beat"   αh = 1, (βh)² = 2: both roots 0, an error is gone in two steps, as under RATTLE
//   "reversible"  αh = 0.05, (βh)² = 2: nearly time-reversible, keeps energy
//   "numbers"     α and β as given
// A given α or β stands in place of the named one.
// Throws InputError for an unknown name, missing numbers, or gains the step cannot bear (α < 0, βh ≥ 2).
Gains choose_gains(const std::string& name, std::optional<double> alpha, std::optional<double> beta,
                   double h);

// The gains whose step has both roots equal to r, 0 ≤ r < 1: an error shrinks by r a step.
Gains gains_for_root(double r, double h);

}  // namespace taut
