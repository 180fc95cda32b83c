#include "forcefield/check_positions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/errors.hpp"

namespace taut {

// The sum of all squares is cheap, and tells of every atom at once where none is far off.
void check_positions(const Vectors& x) {
  constexpr double kFarthest = 1e15;  // [nm]
  if (x.squaredNorm() < kFarthest * kFarthest) return;
  for (Eigen::Index a = 0; a < x.cols(); ++a) {
    if (!x.col(a).allFinite())
      throw SimulationFailure(
          fmt::format("atom {}: position ({}, {}, {}) nm is not finite", a, x(0, a), x(1, a), x(2, a)));
    if (!(x.col(a).cwiseAbs().maxCoeff() < kFarthest))
      throw SimulationFailure(fmt::format("atom {} ran away: it is at ({:.4g}, {:.4g}, {:.4g}) nm", a,
                                          x(0, a), x(1, a), x(2, a)));
  }
}

// Atoms are compared with those whose distance from the box's nearest face, or x, is about theirs.
void refuse_atoms_in_one_place(const Box& box, const Vectors& x) {
  constexpr double kSame = 1e-9, kNear = 1e-7;  // [nm]; [edges of the box], or [nm]
  const auto place = [&](Eigen::Index a) {
    const double along = box.periodic() ? box.fractional(x.col(a)).x() : x(0, a);
    return box.periodic() ? std::abs(along - std::round(along)) : along;
  };
  std::vector<std::pair<double, int>> order;
  for (Eigen::Index a = 0; a < x.cols(); ++a) order.emplace_back(place(a), static_cast<int>(a));
  std::ranges::sort(order);
  for (auto one = order.begin(); one != order.end(); ++one)
    for (auto two = one + 1; two != order.end() && two->first - one->first < kNear; ++two) {
      const auto [a, b] = std::minmax(one->second, two->second);
      if (!(box.nearest_image(x.col(b) - x.col(a)).norm() < kSame)) continue;
      throw InputError(
          fmt::format("the start: atoms {} and {} are in one place, ({:.6g}, {:.6g}, {:.6g}) nm, and no "
                      "force between them has a direction; move one of them",
                      a, b, x(0, a), x(1, a), x(2, a)));
    }
}

}  // namespace taut
