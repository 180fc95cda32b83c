#pragma once

#include <vector>

#include "base/vectors.hpp"
#include "md/box.hpp"
#include "systems/openmm/forces.hpp"

namespace taut {

// The positions of the atoms, and the molecule of each.
struct WholeMolecules {
  const System& sys;
  Box box;
  Vectors as_given, whole;  // positions [nm], 3 x n
  std::vector<int> molecule;

  bool near(const Vec3& a, const Vec3& b) const {
    return ((a - b).cwiseAbs().array() < 1e-6 * box.edge.array()).all();
  }
};

// taut evaluates bonded terms and exceptions without images, with whole molecules; of molecules that meet their own
// image it takes the nearest images. This agrees with OpenMM
// - for a force that uses nearest images, if the atoms of each term belong to one molecule and are near each
//   other;
// - for other forces, if the molecules of their terms are whole in the State.
// Refuses the first term for which it does not agree. (In a uniform field, moving an atom by an edge of the box changes the potential
//   by a constant.)
void check_images(const Element& at, const OpenMMForce& force, const WholeMolecules& molecules);

// OpenMM places a virtual site without images: refuses the first site whose parents are not whole in the
// State.
void check_images(const Element& at, const VirtualSites& sites, const WholeMolecules& molecules);

}  // namespace taut
