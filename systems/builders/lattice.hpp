#pragma once

// Grids of cells that fill a box, on which builders place molecules.

#include "md/box.hpp"

namespace taut {

inline constexpr double kGramPerCm3 = 602.214076;  // [u/nm³]

struct Grid {
  int nx, ny, nz;

  long sites() const { return static_cast<long>(nx) * ny * nz; }
  long columns() const { return static_cast<long>(nx) * ny; }
};

// Returns cell c of an n × n × n grid, counted along x first.
Vec3 cube_cell(long c, long n);

// Returns the numbers of cells of the given shape [nm] along the edges of a box that is nearly a cube and has
// at least `cells` cells, and few more. ny is a multiple of ny_step. Throws InputError if no such box exists.
Grid fit_grid(long cells, const Vec3& cell, int ny_step = 1);

// A grid of `count` sites in a rectangular region. Sites left over are spread evenly. A flat region has one
// layer, a thin one has one row.
class RegionGrid {
 public:
  RegionGrid(const Vec3& edge, long count);  // [nm]
  Vec3 site(long m) const;                   // the centre of the m-th cell in use [nm]

 private:
  Vec3 edge_;
  long count_;
  Eigen::Matrix<long, 3, 1> n_;
};

// Columns along z on a hexagonal lattice: every column has six neighbours at `spacing`. It is periodic for
// even ny.
struct HexagonalColumns {
  double spacing;  // [nm]

  // Returns the spacing s at which a column has this area [nm²], √3/2 s².
  static HexagonalColumns of_area(double area);
  // Returns the edges of a cell of one column of this height.
  Vec3 cell(double height) const;
  // Returns the position of column c, row after row in alternating directions, so that consecutive columns
  // are neighbours.
  Vec3 column(const Grid& grid, long c) const;
};

}  // namespace taut
