#pragma once

#include <cmath>

#include "forcefield/terms.hpp"

// Atoms of two kinds, for closed forms.

namespace taut::tests {

// Two atoms, or more of the same two kinds in turn: one charged and large, one charged and small.
inline Nonbonded two_kinds(int n) {
  Nonbonded nb;
  nb.charge.resize(n);
  nb.sigma.resize(n);
  nb.epsilon.resize(n);
  for (int a = 0; a < n; ++a) {
    nb.charge[a] = a % 2 ? -0.8 : 0.5;
    nb.sigma[a] = a % 2 ? 0.2 : 0.3;
    nb.epsilon[a] = a % 2 ? 0.25 : 0.64;
  }
  return nb;
}

inline Nonbonded without_charges(Nonbonded nb) {
  nb.charge.setZero();
  return nb;
}

inline Nonbonded without_lj(Nonbonded nb) {
  nb.epsilon.setZero();
  return nb;
}

inline double lj(double sigma, double epsilon, double r) {
  return 4 * epsilon * (std::pow(sigma / r, 12) - std::pow(sigma / r, 6));
}

}  // namespace taut::tests
