#pragma once

#include <vector>

#include "md/vectors.hpp"

namespace taut {

// One distance held: |x_j − x_i| = length.
struct RigidBond {
  int i, j;
  double length;  // [nm]
};

// What does not change during a run. Build it with make_system.
struct System {
  Eigen::VectorXd mass;          // [u], n; 0 for an anchored atom
  Eigen::VectorXd inv_mass;      // [1/u], n; 0 for an anchored atom
  std::vector<RigidBond> bonds;  // m

  int atoms() const { return static_cast<int>(mass.size()); }
  int bond_count() const { return static_cast<int>(bonds.size()); }
};

// Mass 0 anchors an atom: it never moves (OpenMM's convention).
// Throws InputError for a bond out of range, between an atom and itself, repeated, of no length, or
// between two anchored atoms, and for a negative or non-finite mass.
System make_system(Eigen::VectorXd mass, std::vector<RigidBond> bonds);

}  // namespace taut
