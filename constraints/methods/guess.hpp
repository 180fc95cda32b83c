#pragma once

#include <vector>

#include "md/system.hpp"

namespace taut {

// Baumgarte's λ* = λ₁ + first (λ₁ − λ₂) + second (λ₂ − λ₃), of the three steps before.
struct Guess {
  double first = 0, second = 0;
};

// Where bonds form chains and nets: it misses by −⅔hλ̇ + 0·h²λ̈.
constexpr Guess kThird = {1.0 / 3, 0};

// Where each bond of a cluster meets every other one: a water, the rigid hydrogens of a carbon or nitrogen.
// What it misses does no work there (README.md, "The guess").
constexpr Guess kOfSmallClusters = {1.0 / 3, -0.8};

// For each bond, whether it couples with all others of its cluster.
std::vector<bool> meets_all_others(const System& sys);

// Of `wanted`, what can be had of so many steps.
constexpr Guess known(const Guess& wanted, int steps) {
  if (steps < 2) return {};
  return steps < 3 ? Guess{wanted.first, 0} : wanted;
}

}  // namespace taut
