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

// And back: a along x, b in the plane of x and y.
inline Box box_of(const UnitCell& cell) {
  const auto cosine = [&](int d) {
    return cell.angle[d] == 90 ? 0 : std::cos(cell.angle[d] * std::numbers::pi / 180);
  };
  const auto& [a, b, c] = cell.length;
  const double sine = std::sqrt(1 - cosine(2) * cosine(2));
  const double cx = cosine(1), cy = (cosine(0) - cosine(1) * cosine(2)) / sine;
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  m.col(0) << a, 0, 0;
  m.col(1) << b * cosine(2), b * sine, 0;
  m.col(2) << c * cx, c * cy, c * std::sqrt(1 - cx * cx - cy * cy);
  return Box::of(m / 10);
}

}  // namespace taut
