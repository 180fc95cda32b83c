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
};

// What atoms give to grid points from the one below them on, along each edge, and the slopes of that: the
// cardinal B-splines M_n(w + n − 1 − k) (Essmann et al. 1995, doi:10.1063/1.470117, eqs. 4.1 and 4.2), w =
// above, 0 … 1, by
//     M_n(u) = (u M_{n−1}(u) + (n − u) M_{n−1}(u − 1))/(n − 1),   dM_n/du = M_{n−1}(u) − M_{n−1}(u − 1)
// from the hat of order 2. An atom has `room` of either for each edge, zeros beyond the order.
struct MeshSplines {
  double *weight, *slope;

  static constexpr int room(int order) { return order <= 4 ? 4 : kMostOrder; }
};

// The real grid, plane by plane, row by row.
struct MeshGrid {
  double* plane;  // the first
  std::array<int, 3> size;
  int stride;  // numbers a row: as many as the grid has, and kMostOrder that splines reach beyond it
  int order;
};

// Those from `begin` to `end`, which are places in both.
struct MeshAtoms {
  const MeshAtom* atom;
  MeshSplines splines;
  int begin, end;
};

// Of atoms that are so far above their points, each to its place.
struct AbovePoints {
  const std::array<double, 3>* above;
  const int* place;
  int count;
};
void find_splines(int order, const AbovePoints& atoms, const MeshSplines& splines);

// Adds to a plane the charges of atoms that are k planes below.
void spread_charges(const MeshGrid& grid, int plane, const MeshAtoms& atoms, int k);

// Σ φ dw/du at each of the atoms, u in grid points along each edge.
void find_slopes(const MeshGrid& grid, const MeshAtoms& atoms, Vec3* slope);

}  // namespace taut
