#pragma once

#include <string>
#include <vector>

#include "systems/scene/scene.hpp"

namespace taut {

constexpr double kLammpsAnchorMass = 1e6;  // [u]: LAMMPS takes no 0, and no fix moves anchors

// The walls that act on each atom, one bit each; atoms of one type must be before the same ones.
std::vector<long> walls_of_atoms(const Scene& scene);

// Where LAMMPS's box begins: with a slit in the middle of it, so that no image of an atom is behind a wall.
Vec3 lower_corner(const Scene& scene);

// Lines of an input for what acts from outside. Anchors and walls have groups of types.
struct LammpsOuterForces {
  std::string moving = "all";  // the group of all atoms that are no anchors, which fixes move
  std::string fixed;           // anchors, for fix taut
  std::string groups, fixes;
};
// `types` has the first atom of each type.
LammpsOuterForces outer_forces(const Scene& scene, const std::vector<int>& types);

}  // namespace taut
