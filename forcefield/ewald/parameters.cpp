#include "forcefield/ewald/parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"

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

EwaldErrors ewald_errors(const PmeParameters& p, const Box& box, double cutoff) {
  double coarsest = 0;
  for (int d = 0; d < 3; ++d) coarsest = std::max(coarsest, box.edge[d] / p.grid[d]);
  return {0.5 * std::exp(-std::pow(p.alpha * cutoff, 2)), std::pow(2 * p.alpha * coarsest / 3, p.order)};
}

std::string doubt_of(const PmeParameters& p, const Box& box, double cutoff) {
  constexpr double kFarOver = 10;
  const EwaldErrors wrong_by = ewald_errors(p, box, cutoff);
  const std::string beside = fmt::format("of themselves, where the tolerance is {:g}", p.tolerance);
  if (wrong_by.pairs > kFarOver * p.tolerance)
    return fmt::format(
        "Ewald's sum with α = {:g}/nm leaves forces wrong by about {:.2g} {}, for pairs end at {:g} nm; give "
        "no ewald_alpha_per_nm, or a larger one",
        p.alpha, wrong_by.pairs, beside, cutoff);
  if (wrong_by.mesh > kFarOver * p.tolerance)
    return fmt::format(
        "Ewald's sum on {} × {} × {} points with α = {:.4g}/nm and order {} leaves forces wrong by about "
        "{:.2g} "
        "{}; give no pme_grid, or a finer one",
        p.grid[0], p.grid[1], p.grid[2], p.alpha, p.order, wrong_by.mesh, beside);
  return "";
}

}  // namespace taut
