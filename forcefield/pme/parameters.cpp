#include "forcefield/pme/parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "md/errors.hpp"

namespace taut {
namespace {

constexpr double kMostPoints = 1 << 28;  // of the grid: 4 GB
constexpr double kWidest = 8;            // α r_c: erfc(8) is 1e-29

int next_that_transforms_fast(int size) {
  for (;; ++size) {
    int rest = size;
    for (const int factor : {2, 3, 5, 7})
      while (rest % factor == 0) rest /= factor;
    if (rest == 1) return size;
  }
}

}  // namespace

PmeParameters chosen_parameters(const PmeParameters& given, const Box& box, double cutoff) {
  PmeParameters p = given;
  if (p.order < kLeastOrder || p.order > kMostOrder)
    throw PmeError(PmeError::kOrder,
                   fmt::format("pme: order {}, expected {} to {}", p.order, kLeastOrder, kMostOrder));
  if (!(p.tolerance > 0 && p.tolerance < 0.5))
    throw PmeError(PmeError::kTolerance,
                   fmt::format("pme: tolerance {}, expected between 0 and 0.5", p.tolerance));
  if (p.alpha == 0) p.alpha = std::sqrt(-std::log(2 * p.tolerance)) / cutoff;
  if (!(p.alpha > 0 && p.alpha * cutoff <= kWidest))
    throw PmeError(PmeError::kAlpha,
                   fmt::format("pme: alpha {} per nm, expected more than 0 and at most {} over the cutoff",
                               p.alpha, kWidest));
  double points = 1;
  for (int d = 0; d < 3; ++d) {
    int& size = p.grid[d];
    double wanted = size;
    if (size == 0)
      wanted = std::max(6.0, std::ceil(2 * p.alpha * box.edge[d] / (3 * std::pow(p.tolerance, 0.2))));
    if (wanted < p.order)
      throw PmeError(
          PmeError::kGrid,
          fmt::format("pme: {} grid points along an edge, fewer than the order {}", wanted, p.order));
    points *= wanted;
    if (points > kMostPoints)
      throw PmeError(
          PmeError::kGrid,
          size > 0
              ? fmt::format("pme: a grid of {} points, expected at most {:.0f} in all",
                            fmt::join(p.grid, " x "), kMostPoints)
              : fmt::format(
                    "pme: a tolerance of {} and alpha {:.4g} per nm ask for a grid of {} points along an "
                    "edge of {} nm, too many: ask for less",
                    p.tolerance, p.alpha, wanted, box.edge[d]));
    if (size == 0) size = next_that_transforms_fast(static_cast<int>(wanted));
  }
  return p;
}

}  // namespace taut
