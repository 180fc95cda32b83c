#pragma once

#include <cmath>
#include <string_view>

#include "md/units.hpp"

namespace taut {

// taut's units of a unit style of LAMMPS.
struct LammpsUnits {
  double length;    // [nm]
  double energy;    // [kJ/mol]
  double mass;      // [u]
  double velocity;  // [nm/ps]
  double charge;    // [e]

  static LammpsUnits real() { return {0.1, 4.184, 1, 100, 1}; }
  static LammpsUnits metal() { return {0.1, 96.48533212331, 1, 0.1, 1}; }
  // Of Lennard-Jones units with this σ, ε and mass. With 1 nm, 1 kJ/mol and 1 u all numbers are taut's own, and the
  // unit of time is 1 ps.
  static LammpsUnits lj(double sigma, double epsilon, double mass) {
    return {sigma, epsilon, mass, std::sqrt(epsilon / mass), std::sqrt(sigma * epsilon / kCoulomb)};
  }
};

}  // namespace taut
