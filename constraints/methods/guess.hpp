#pragma once

#include <vector>

#include "md/system.hpp"

namespace taut {

// Coefficients of Baumgarte's guess λ* = λ₁ + first (λ₁ − λ₂) + second (λ₂ − λ₃) from the previous three
// steps.
struct Guess {
  double first = 0, second = 0;
};

// For chains and nets of bonds. The error of this guess is −⅔hλ̇ + 0·h²λ̈.
constexpr Guess kThird = {1.0 / 3, 0};

// For clusters in which every bond shares an atom with every other one: a water, the rigid hydrogens of a
// carbon or nitrogen. The error of this guess does no work there (README.md, "The guess").
constexpr Guess kOfSmallClusters = {1.0 / 3, -0.8};

// Returns, for each bond, whether it is coupled to all other bonds of its cluster.
std::vector<bool> meets_all_others(const System& sys);

// Returns the guess that so many previous steps allow: `wanted` from three steps on.
constexpr Guess limit_to_known(const Guess& wanted, int steps) {
  if (steps < 2) return {};
  return steps < 3 ? Guess{wanted.first, 0} : wanted;
}

}  // namespace taut
