#include "files/unit_cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace taut {
namespace {

// Tolerances as fractions of half an edge.
constexpr double kSinglePrecision = 1e-6;  // a tilt that exceeds the half by less is kept (md/box.cpp)
constexpr double kMargin = 1e-2;           // the largest rounding that is accepted

bool is_box(const Eigen::Matrix3d& m) {
  return m.allFinite() && m.diagonal().minCoeff() > 0 && m(1, 0) == 0 && m(2, 0) == 0 && m(2, 1) == 0;
}

}  // namespace

UnitCell to_unit_cell(const Box& box) {
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

Eigen::Matrix3d lattice_vectors(const UnitCell& cell) {
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
  return m;
}

Box to_box(const UnitCell& cell) {
  return Box::of(lattice_vectors(cell) / 10);
}

ReducedBox reduce_box(const Eigen::Matrix3d& vectors, double rounding) {
  if (!is_box(vectors)) return {{}, Box::flaw(vectors), ""};
  Eigen::Matrix3d m = vectors;
  std::string changes;
  // Reduces the tilt of vector `from` along the edge of vector `other` to at most half that edge.
  const auto reduce = [&](int from, int other) {
    const double edge = m(other, other), half = edge / 2;
    double& tilt = m(other, from);
    if (std::abs(tilt) <= (1 + kSinglePrecision) * half) return;
    if (std::abs(tilt) > half + std::min(rounding, kMargin * half)) {
      const double times = std::round(tilt / edge);
      m.col(from) -= times * m.col(other);
      changes += fmt::format("{}{} {} {}{}", changes.empty() ? "" : ", ", "abc"[from], times > 0 ? '-' : '+',
                             std::abs(times) == 1 ? "" : fmt::format("{:g}", std::abs(times)), "abc"[other]);
    }
    if (std::abs(tilt) > half) tilt = std::copysign(half, tilt);
  };
  reduce(1, 0);
  reduce(2, 1);
  reduce(2, 0);
  return {Box::of(m), Box::flaw(m), changes};
}

}  // namespace taut
