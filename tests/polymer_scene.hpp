#pragma once

#include "scene_text.hpp"

namespace taut {

inline const std::string kPolymers = R"([molecule.polymer]
atoms = [{name = "B", mass_u = 72, sigma_nm = 0.47, epsilon_kj_mol = 3.5}]
units = 20
bonds = [[0, 1, 0.35]]
angles = [[0, 1, 2, 120, 25]]
[[place]]
molecule = "polymer"
count = 3
[build]
box_nm = 5
[forcefield]
cutoff_nm = 1.1
)";

// Three chains in one place, which no run can begin with unless they are pushed apart.
inline const std::string kCrowd = R"([molecule.chain]
atoms = [{name = "B", mass_u = 72, sigma_nm = 0.47, epsilon_kj_mol = 2.5}]
units = 10
bonds = [[0, 1, 0.456]]
[[place]]
molecule = "chain"
count = 3
centres_nm = [[1, 1, 1], [1, 1, 1], [1.01, 1, 1]]
[build]
box_nm = 5
[forcefield]
pair = "wca"
[run]
temperature_k = 300
thermostat = "langevin"
)";
inline const std::string kPartTheCrowd = "minimise = true\nsoft_start = true\n";

inline std::string with(const std::string& text, const std::string& old, const std::string& changed) {
  return SceneText{text}.with(old, changed).text;
}

// Returns the least distance, in σ, of two atoms that no term holds close to each other.
inline double nearest(const Scene& scene) {
  const Nonbonded& nb = *scene.terms.nonbonded;
  std::set<std::pair<int, int>> near;
  for (const auto& pair : nb.exceptions) near.insert(std::minmax(pair.i, pair.j));
  double least = 1e9;
  for (int a = 0; a < scene.system.atoms(); ++a)
    for (int b = a + 1; b < scene.system.atoms(); ++b) {
      if (near.contains({a, b}) || nb.epsilon[a] == 0 || nb.epsilon[b] == 0) continue;
      const double r = scene.start.box.nearest_image(scene.start.x.col(b) - scene.start.x.col(a)).norm();
      least = std::min(least, 2 * r / (nb.sigma[a] + nb.sigma[b]));
    }
  return least;
}

}  // namespace taut
