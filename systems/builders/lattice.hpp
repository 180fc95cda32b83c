#pragma once

// Where builders put molecules: grids of cells that fill a box.

#include "md/box.hpp"

namespace taut {

inline constexpr double kGramPerCm3 = 602.214076;  // [u/nm³]

struct Grid {
  int nx, ny, nz;

  long sites() const { return static_cast<long>(nx) * ny * nz; }
  long columns() const { return static_cast<long>(nx) * ny; }
};

// Cell c of n × n × n, counted along x first.
Vec3 cube_cell(long c, long n);

// At least `cells` cells of the given shape [nm]: near to a cube, and with few left over. ny is a multiple of
// ny_step. Throws InputError for a shape that no such box can be made of.
Grid fit_grid(long cells, const Vec3& cell, int ny_step = 1);

// A grid in a brick, for so many; sites left empty are spread evenly. A flat brick has one layer, a
// thin one one row.
class BrickGrid {
 public:
  BrickGrid(const Vec3& edge, long count);  // [nm]
  Vec3 site(long m) const;                  // the middle of the cell that the m-th has [nm]

 private:
  Vec3 edge_;
  long count_;
  Eigen::Matrix<long, 3, 1> n_;
};

// Columns along z on a hexagonal lattice: every column has its six neighbours at `spacing`. Periodic for an
// even ny.
struct HexagonalColumns {
  double spacing;  // [nm]

  // The spacing at which a column has this area [nm²]: √3/2 s².
  static HexagonalColumns of_area(double area);
  // A cell of one column, `height` long.
  Vec3 cell(double height) const;
  // Column c of the grid, row after row, each row against the direction of the one before: consecutive
  // columns are neighbours.
  Vec3 column(const Grid& grid, long c) const;
};

}  // namespace taut
