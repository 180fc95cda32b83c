#pragma once

#include <string>

#include "md/box.hpp"

namespace taut {

// A box as a file says it, brought to the reduced form of md/box.hpp.
struct ReducedBox {
  Box box;
  std::string flaw;     // why the vectors are no box, with what was expected; empty: they are one
  std::string changes;  // which whole vectors were taken off; empty: none
};

// Reduces vectors a = (ax, 0, 0), b = (bx, by, 0), c = (cx, cy, cz), the columns [nm].
//
// A tilt that is more than half its edge by what the file rounds is set to that half: GROMACS writes a
// dodecahedron of a = 3.12345 nm with a tilt of 1.56173 nm. `rounding` is how much that may be [nm]; never
// more than a thousandth of the half, which is GROMACS's own margin. Beyond it whole vectors are taken off,
// which leaves the lattice as it is.
ReducedBox reduced_box(const Eigen::Matrix3d& vectors, double rounding);

}  // namespace taut
