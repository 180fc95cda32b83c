#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "base/worse.hpp"

namespace taut {

// Why a solve gave up.
enum class Failure : std::uint8_t {
  kNone,
  kSingular,
  kNoConvergence,
  kVelocitiesNoConvergence,
  kTurned,            // a bond by 90° or more
  kSingularOrTurned,  // A' is singular, which a bond that turns by 90° makes it, too
  kRanAway,
  kShapeLost,  // a water drifted so far that no rotation brings it back
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

// What a method did in one step. Not to be dropped: who does not look at it goes on with broken bonds.
struct [[nodiscard]] SolveStats {
  int iterations = 0;                // sweeps or linear solves
  double max_residual = 0;           // largest |σ|/d² it saw and left
  int worst_bond = -1;               // where; of a failure: the bond to blame
  Failure failure = Failure::kNone;  // why it gave up

  bool converged() const { return failure == Failure::kNone; }

  // One stage after another: iterations add up.
  SolveStats& operator+=(const SolveStats& next) {
    iterations += next.iterations;
    return keep_worst(next);
  }
  // Clusters or threads side by side: the most iterations.
  SolveStats& beside(const SolveStats& other) {
    iterations = std::max(iterations, other.iterations);
    return keep_worst(other);
  }

 private:
  // The first failure with the bond and the residual that are its own; where all converged the worst
  // residual.
  SolveStats& keep_worst(const SolveStats& other) {
    const bool replaced = converged() && (!other.converged() || worse(other.max_residual, max_residual));
    if (!replaced) return *this;
    max_residual = other.max_residual;
    worst_bond = other.worst_bond;
    failure = other.failure;
    return *this;
  }
};

}  // namespace taut
