#pragma once

#include <array>

#include "forcefield/pme/parameters.hpp"
#include "md/vectors.hpp"

namespace taut {

// A charge on the mesh.
struct MeshAtom {
  std::array<int, 3> point;  // of the grid, the one below it
  int atom;
  double charge;  // √k q [√(kJ/mol·nm)]
  std::array<std::array<double, kMostOrder>, 3> weight, slope;
};

// The real grid, plane by plane, row by row.
struct MeshGrid {
  double* plane;  // the first
  std::array<int, 3> size;
  int stride;  // numbers a row: as many as the grid has, and kMostOrder that splines reach beyond it
  int order;
};

struct MeshAtoms {
  const MeshAtom *begin, *end;
};

// What an atom gives to grid points from the one below it on, along each edge, and the slopes of that: the
// cardinal B-splines M_n(w + n − 1 − k) (Essmann et al. 1995, doi:10.1063/1.470117, eqs. 4.1 and 4.2), w =
// above, 0 … 1, by
//     M_n(u) = (u M_{n−1}(u) + (n − u) M_{n−1}(u − 1))/(n − 1),   dM_n/du = M_{n−1}(u) − M_{n−1}(u − 1)
// from the hat of order 2. Zeros beyond the order.
void find_splines(int order, const std::array<double, 3>& above, MeshAtom& atom);

// Adds to a plane the charges of atoms that are k planes below.
void spread_charges(const MeshGrid& grid, int plane, MeshAtoms atoms, int k);

// Σ φ dw/du at the atom, u in grid points along each edge.
Vec3 slope_at(const MeshGrid& grid, const MeshAtom& atom);

}  // namespace taut
