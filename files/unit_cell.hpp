#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "md/box.hpp"

namespace taut {

// A box as crystallographers say it.
struct UnitCell {
  std::array<double, 3> length;  // |a|, |b|, |c| [Å]
  std::array<double, 3> angle;   // α of b and c, β of a and c, γ of a and b [°]
};

inline UnitCell unit_cell(const Box& box) {
  const Eigen::Matrix3d m = 10 * box.vectors();
  UnitCell cell;
  for (int d = 0; d < 3; ++d) cell.length[d] = m.col(d).norm();
  for (int d = 0; d < 3; ++d) {
    const int i = (d + 1) % 3, j = (d + 2) % 3;
    const double cosine = m.col(i).dot(m.col(j)) / (cell.length[i] * cell.length[j]);
    cell.angle[d] = cosine == 0 ? 90 : std::acos(cosine) * 180 / std::numbers::pi;
  }
  return cell;
}

}  // namespace taut
