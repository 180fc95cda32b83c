#include "forcefield/check_positions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
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

void refuse_atoms_in_one_place(const Box& box, const Vectors& x) {
  constexpr double kSame = 1e-9;  // [nm]
  Vectors wrapped = x;
  for (Eigen::Index a = 0; a < x.cols(); ++a)
    if (box.periodic()) wrapped.col(a) -= box.lattice_vector(box.cell_of(x.col(a), std::floor));
  std::vector<int> order(static_cast<std::size_t>(x.cols()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](int a) { return wrapped(0, a); });
  for (auto one = order.begin(); one != order.end(); ++one)
    for (auto two = one + 1; two != order.end() && wrapped(0, *two) - wrapped(0, *one) < kSame; ++two) {
      const Vec3 apart = x.col(*two) - x.col(*one);
      if (!(box.nearest_image(apart).norm() < kSame)) continue;
      throw InputError(
          fmt::format("the start: atoms {} and {} are in one place, ({:.6g}, {:.6g}, {:.6g}) nm, and no "
                      "force between them has a direction; move one of them",
                      std::min(*one, *two), std::max(*one, *two), x(0, *one), x(1, *one), x(2, *one)));
    }
}

}  // namespace taut
