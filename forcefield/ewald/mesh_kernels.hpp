#pragma once

#include <array>
#include <complex>
#include <span>

#include "base/vectors.hpp"
#include "forcefield/ewald/parameters.hpp"

namespace taut {

struct Charged {
  int atom;
  double charge;  // √k q [√(kJ/mol·nm)]
};

// A charge on the mesh. What it gives to grid points from the one below it on, along each edge, are the
// cardinal B-splines M_n(w + n − 1 − k) (Essmann et al. 1995, doi:10.1063/1.470117, eqs. 4.1 and 4.2), w =
// above, by
//     M_n(u) = (u M_{n−1}(u) + (n − u) M_{n−1}(u − 1))/(n − 1),   dM_n/du = M_{n−1}(u) − M_{n−1}(u − 1)
// from the hat of order 2. They are found wherever they are wanted, many atoms at a time: sooner than kept.
template <class T>
struct MeshAtom {
  std::array<T, 3> above;  // 0 … 1
  T charge;
  std::array<int, 3> point;  // of the grid, the one below it
  int atom;
};
template <class T>
using MeshAtoms = std::span<const MeshAtom<T>>;

// Splines are stored in fours: so far do they reach beyond the last row and the last point of one.
constexpr int reach(int order) {
  return order <= 4 ? 4 : kMostOrder;
}

// The real grid, plane by plane, row by row, with room for what they reach.
template <class T>
struct MeshGrid {
  T* plane;  // the first
  std::array<int, 3> size;
  std::ptrdiff_t stride, apart;  // numbers a row, a plane
  int order;
};

// From places to the grid: `into` · x counts the grid's edges.
struct MeshFrame {
  std::array<int, 3> size;
  Eigen::Matrix3d into;  // [1/nm]
};
template <class T>
void find_points(const MeshFrame& frame, const Vectors& x, std::span<const Charged> charged,
                 MeshAtom<T>* out);

// Adds charges of the atoms, all of a plane, to the planes that are so many above it, first to last.
struct PlanesAbove {
  int first, last;
};
template <class T>
void spread_charges(const MeshGrid<T>& grid, const PlanesAbove& planes, MeshAtoms<T> atoms);

// Adds the forces −q · turn · Σ φ dw/du on each of the atoms, u in grid points along each edge.
template <class T>
void add_mesh_forces(const MeshGrid<T>& grid, MeshAtoms<T> atoms, const Eigen::Matrix3d& turn, Vectors& f);

// Each number times its factor g ≥ 0, and what Σ g|z|² then is, of what z was.
template <class T>
double filter(std::span<const T> factor, std::complex<T>* z);

}  // namespace taut
