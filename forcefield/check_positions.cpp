#include "forcefield/check_positions.hpp"

#include <fmt/format.h>

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

}  // namespace taut
