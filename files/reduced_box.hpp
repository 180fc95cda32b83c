#pragma once

#include <string>

#include "md/box.hpp"

namespace taut {

// The box of a file in the reduced form of md/box.hpp.
struct ReducedBox {
  Box box;
  std::string flaw;     // why the vectors are not a box, and what was expected; else empty
  std::string changes;  // which lattice vectors were subtracted; empty if none
};

// Reduces vectors a = (ax, 0, 0), b = (bx, by, 0), c = (cx, cy, cz), the columns [nm].
//
// A tilt that exceeds half its edge by a rounding error is set to that half: GROMACS writes a dodecahedron of
// a = 3.12345 nm with a tilt of 1.56173 nm. `rounding` is the largest such error [nm], and at most a
// thousandth of the half, which is GROMACS's margin. A larger tilt is reduced by lattice vectors, which does
// not change the lattice.
ReducedBox reduced_box(const Eigen::Matrix3d& vectors, double rounding);

}  // namespace taut
