#include "systems/builders/lattice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/errors.hpp"

namespace taut {
namespace {

constexpr double kMostStretched = 8;        // limit on one layer of cells relative to all
const double kRowHeight = std::sqrt(0.75);  // of a hexagonal lattice, in units of the spacing

// Returns the numbers of cells to try along an edge that should have `ideal` cells.
struct CountsToTry {
  int least, most;
  CountsToTry(double ideal, int step)
      : least(std::max(step, static_cast<int>(0.7 * ideal) / step * step)),
        most(static_cast<int>(std::ceil(1.4 * ideal)) + step) {}
};

}  // namespace

Vec3 cube_cell(long c, long n) {
  return Eigen::Matrix<long, 3, 1>(c % n, c / n % n, c / n / n).cast<double>();
}

Grid fit_grid(long cells, const Vec3& cell, int ny_step) {
  const double edge = std::cbrt(static_cast<double>(cells) * cell.prod());
  const double ideal_y = edge / cell.y(), ideal_z = edge / cell.z();
  if (!((ideal_y + 1) * (ideal_z + 1) < kMostStretched * static_cast<double>(cells + 8)))
    throw InputError(fmt::format("no box near to a cube holds {} cells of {:.3g} × {:.3g} × {:.3g} nm", cells,
                                 cell.x(), cell.y(), cell.z()));
  const CountsToTry y(ideal_y, ny_step), z(ideal_z, 1);
  Grid best{};
  double least_cost = std::numeric_limits<double>::infinity();
  for (int nz = z.least; nz <= z.most; ++nz)
    for (int ny = y.least; ny <= y.most; ny += ny_step) {
      const long layer = static_cast<long>(ny) * nz;
      const Grid grid{static_cast<int>((cells + layer - 1) / layer), ny, nz};
      const Vec3 edges = cell.cwiseProduct(Vec3(grid.nx, grid.ny, grid.nz));
      const double left_over = static_cast<double>(grid.sites()) / static_cast<double>(cells) - 1;
      const double cost = 4 * left_over + edges.maxCoeff() / edges.minCoeff() - 1;
      if (cost < least_cost) {
        least_cost = cost;
        best = grid;
      }
    }
  return best;
}

RegionGrid::RegionGrid(const Vec3& edge, long count) : edge_(edge), count_(count) {
  const double all = static_cast<double>(count);
  Vec3 sorted = edge;
  std::sort(sorted.data(), sorted.data() + 3);
  const auto& [thinnest, middle, longest] = std::array{sorted[0], sorted[1], sorted[2]};
  double apart = std::cbrt(edge.prod() / all);
  if (thinnest <= apart) apart = std::sqrt(middle * longest / all);  // one layer
  if (middle <= apart) apart = longest / all;                        // one row
  n_ = (edge_.array() / apart - 1e-9).ceil().max(1).cast<long>();
}

Vec3 RegionGrid::site(long m) const {
  const long site = m * n_.prod() / count_;
  const Eigen::Array3d cell =
      Eigen::Array<long, 3, 1>(site % n_[0], site / n_[0] % n_[1], site / n_[0] / n_[1]).cast<double>();
  return edge_.array() / n_.cast<double>().array() * (cell + 0.5);
}

HexagonalColumns HexagonalColumns::of_area(double area) {
  return {std::sqrt(area / kRowHeight)};
}

Vec3 HexagonalColumns::cell(double height) const {
  return {spacing, kRowHeight * spacing, height};
}

Vec3 HexagonalColumns::column(const Grid& grid, long c) const {
  const long row = c / grid.nx, along = c % grid.nx;
  const long place = row % 2 == 0 ? along : grid.nx - 1 - along;
  return {spacing * (static_cast<double>(place) + (row % 2 == 0 ? 0.0 : 0.5)),
          kRowHeight * spacing * static_cast<double>(row), 0};
}

}  // namespace taut
