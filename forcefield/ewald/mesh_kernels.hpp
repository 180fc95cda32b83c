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

// A charge on the mesh. Along each edge it is spread over n grid points, k = 0 … n − 1, counted from the one
// below it, with the cardinal B-splines M_n(w + n − 1 − k) as weights (Essmann et al. 1995,
// doi:10.1063/1.470117, eqs. 4.1 and 4.2), w = above:
//     M_n(u) = (u M_{n−1}(u) + (n − u) M_{n−1}(u − 1))/(n − 1),   dM_n/du = M_{n−1}(u) − M_{n−1}(u − 1)
// from the hat function of order 2. Weights are computed wherever they are needed, many atoms at a time,
// which is faster than to store them.
template <class T>
struct MeshAtom {
  std::array<T, 3> above;  // 0 … 1
  T charge;
  std::array<int, 3> point;  // of the grid, the one below it
  int atom;
};
template <class T>
using MeshAtoms = std::span<const MeshAtom<T>>;

// The order rounded up to a multiple of four: weights are stored in fours, and kernels read and write that
// many grid points, beyond the last row and the last point of a row too.
constexpr int padded_order(int order) {
  return order <= 4 ? 4 : kMostOrder;
}

// The real grid, plane by plane and row by row, with room for padded_order() beyond each end.
template <class T>
struct MeshGrid {
  T* plane;  // the first
  std::array<int, 3> size;
  std::ptrdiff_t stride, apart;  // numbers a row, a plane
  int order;
};

// From positions to the grid: `into` · x is the position in fractions of the box's edges.
struct MeshFrame {
  std::array<int, 3> size;
  Eigen::Matrix3d into;  // [1/nm]
};
template <class T>
void find_points(const MeshFrame& frame, const Vectors& x, std::span<const Charged> charged,
                 MeshAtom<T>* out);

// Spreads the charges of atoms that are all in one plane to the planes `first` to `last` above it.
struct PlanesAbove {
  int first, last;
};
template <class T>
void spread_charges(const MeshGrid<T>& grid, const PlanesAbove& planes, MeshAtoms<T> atoms);

// Gathers: adds the forces −q Σ_d ∇u_d Σ φ dw/du_d on each of the atoms, u_d in grid points along each edge. The
// columns of `grid_gradient` are ∇u_d [1/nm].
template <class T>
void add_mesh_forces(const MeshGrid<T>& grid, MeshAtoms<T> atoms, const Eigen::Matrix3d& grid_gradient,
                     Vectors& f);

// Multiplies each number by its factor g ≥ 0; returns Σ g|z|² of the numbers before.
template <class T>
double solve(std::span<const T> factor, std::complex<T>* z);

}  // namespace taut
