#pragma once

#include <array>
#include <string>

#include "md/box.hpp"

namespace taut {

// A box in the notation of crystallography.
struct UnitCell {
  std::array<double, 3> length;  // |a|, |b|, |c| [Å]
  std::array<double, 3> angle;   // α between b and c, β between a and c, γ between a and b [°]
};

UnitCell to_unit_cell(const Box& box);
Box to_box(const UnitCell& cell);

// Returns the cell's vectors as columns, in the unit of its lengths: a lies along x, b in the xy plane.
Eigen::Matrix3d lattice_vectors(const UnitCell& cell);

// A box from a file, in the reduced form of md/box.hpp.
struct ReducedBox {
  Box box;
  std::string flaw;     // why the vectors are no box, and what was expected; empty if they are one
  std::string changes;  // which lattice vectors were subtracted; empty if none
};

// Reduces the vectors a = (ax, 0, 0), b = (bx, by, 0), c = (cx, cy, cz), the columns of the matrix [nm].
//
// A tilt that exceeds half its edge by no more than the file's rounding is set to that half: GROMACS writes a
// dodecahedron with a = 3.12345 nm and a tilt of 1.56173 nm. `rounding` is that tolerance [nm], of which at
// most 1 % of the half edge counts. A larger tilt is reduced by whole lattice vectors, which leaves the
// lattice as it is.
ReducedBox reduce_box(const Eigen::Matrix3d& vectors, double rounding);

}  // namespace taut
