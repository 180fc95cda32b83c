#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "base/exceeds.hpp"

namespace taut {

// Why a method failed in a step.
enum class Failure : std::uint8_t {
  kNone,
  kSingular,
  kNoConvergence,
  kVelocitiesNoConvergence,
  kTurned,            // a bond turned by 90° or more
  kSingularOrTurned,  // A' is singular: bonds depend on each other, or a bond turned by 90°
  kRanAway,
  kShapeLost,  // no rotation restores the shape of a water that drifted too far
};
constexpr std::string_view in_words(Failure failure) {
  switch (failure) {
    case Failure::kNone:
      return "";
    case Failure::kSingular:
      return "A is singular";
    case Failure::kNoConvergence:
      return "no convergence";
    case Failure::kVelocitiesNoConvergence:
      return "no convergence of the velocities";
    case Failure::kTurned:
      return "the bond turned by 90° in one step";
    case Failure::kSingularOrTurned:
      return "A is singular, or a bond turns by 90° in one step";
    case Failure::kRanAway:
      return "the bonds run away";
    case Failure::kShapeLost:
      return "the water turned or stretched too far in one step";
  }
  return "";
}

// What a method did in one step. A caller must look at it, because bonds may be broken.
struct [[nodiscard]] SolveStats {
  long iterations = 0;      // sweeps or linear solves
  double max_residual = 0;  // largest |σ|/d²
  int worst_bond = -1;      // its bond; after a failure, the bond that failed
  Failure failure = Failure::kNone;

  static constexpr double kBroken = 0.5;  // |σ|/d² from which a bond counts as broken

  bool converged() const { return failure == Failure::kNone; }
  bool held() const { return converged() && max_residual < kBroken; }  // no bond broke, either

  // Combines two successive stages; iterations add up.
  SolveStats& operator+=(const SolveStats& next) {
    iterations += next.iterations;
    return keep_worst(next);
  }
  // Combines clusters or threads that ran side by side; the larger number of iterations counts.
  SolveStats& beside(const SolveStats& other) {
    iterations = std::max(iterations, other.iterations);
    return keep_worst(other);
  }

 private:
  // Keeps the first failure with its bond and residual; if all converged, the largest residual.
  SolveStats& keep_worst(const SolveStats& other) {
    const bool replaced = converged() && (!other.converged() || exceeds(other.max_residual, max_residual));
    if (!replaced) return *this;
    max_residual = other.max_residual;
    worst_bond = other.worst_bond;
    failure = other.failure;
    return *this;
  }
};

}  // namespace taut
