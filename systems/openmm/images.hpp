#pragma once

#include <vector>

#include "base/vectors.hpp"
#include "md/box.hpp"
#include "systems/openmm/forces.hpp"

namespace taut {

// Where the atoms are, and to which molecule each belongs.
struct WholeMolecules {
  Box box;
  Vectors as_given, whole;  // positions [nm], 3 x n
  std::vector<int> molecule;

  bool near(const Vec3& a, const Vec3& b) const {
    return ((a - b).cwiseAbs().array() < 1e-6 * box.edge.array()).all();
  }
};

// taut takes bonded terms and exceptions between atoms as they are, with molecules whole. That is what OpenMM
// does
// - with a force between nearest images, if the atoms of each term belong to one molecule and are near;
// - with another, if the molecules of its terms were whole to begin with.
// Refuses the first term it is not. (In a uniform field, an atom moved by an edge of the box is at another
// potential, by a constant.)
void check_images(const Element& at, const OpenMMForce& force, const WholeMolecules& molecules);

// OpenMM places a virtual site among its parents as they are: refuses the first whose parents were not whole.
void check_images(const Element& at, const VirtualSites& sites, const WholeMolecules& molecules);

}  // namespace taut
