#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "md/units.hpp"
#include "systems/scene/scene_file.hpp"
#include "temporary_folder.hpp"

namespace taut::held_pair {

inline constexpr double kT = kBoltzmann * 300;

inline Scene read(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const TemporaryFolder folder;
  return read_scene(folder.write("scene.toml", text), overrides);
}

// Two Lennard-Jones atoms, whose distance is held.
inline const std::string kPair = R"([molecule.pair]
atoms = [{name = "A", mass_u = 40, sigma_nm = 0.34, epsilon_kj_mol = 3}, {name = "B", mass_u = 20, sigma_nm = 0.34, epsilon_kj_mol = 3}]
bonds = [[0, 1, 0.4]]
exclude = "none"
[[place]]
molecule = "pair"
count = 1
[run]
dt_fs = 5
steps = 40000
log_every = 10
temperature_k = 300
thermostat = "langevin"
friction_per_ps = 5
tension_of = [[0, 1]]
)";

inline double lennard_jones(double r) {
  const double s6 = std::pow(0.34 / r, 6);
  return 12 * (s6 * s6 - s6);
}
inline double lennard_jones_force(double r) {
  const double s6 = std::pow(0.34 / r, 6);
  return 12 * (12 * s6 * s6 - 6 * s6) / r;
}

}  // namespace taut::held_pair
