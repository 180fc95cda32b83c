#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "md/units.hpp"
#include "scene_text.hpp"

namespace taut::held_pair {

inline constexpr double kT = kBoltzmann * 300;

// One molecule in a bath, and the two atoms of it whose tension is in the log.
inline std::string in_a_bath(const std::string& name, const std::string& keys, int steps, const char* held) {
  return fmt::format(
      "[molecule.{0}]\n{1}\n[[place]]\nmolecule = \"{0}\"\ncount = 1\n[run]\ndt_fs = 5\nsteps = {2}\n"
      "log_every = 10\ntemperature_k = 300\nthermostat = \"langevin\"\nfriction_per_ps = 5\ntension_of = "
      "[{3}]\n",
      name, keys, steps, held);
}

// Two Lennard-Jones atoms, whose distance is held.
inline const std::string kPair = in_a_bath(
    "pair",
    R"(atoms = [{name = "A", mass_u = 40, sigma_nm = 0.34, epsilon_kj_mol = 3}, {name = "B", mass_u = 20, sigma_nm = 0.34, epsilon_kj_mol = 3}]
bonds = [[0, 1, 0.4]]
exclude = "none")",
    40000, "[0, 1]");

inline double lennard_jones(double r) {
  const double s6 = std::pow(0.34 / r, 6);
  return 12 * (s6 * s6 - s6);
}
inline double lennard_jones_force(double r) {
  const double s6 = std::pow(0.34 / r, 6);
  return 12 * (12 * s6 * s6 - 6 * s6) / r;
}

}  // namespace taut::held_pair
