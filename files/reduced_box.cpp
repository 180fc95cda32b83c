#include "files/reduced_box.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace taut {
namespace {

// Shares of half an edge.
constexpr double kSinglePrecision = 1e-6;  // a tilt beyond the half by no more stays as it is (md/box.cpp)
constexpr double kMargin = 1e-2;           // the largest rounding

bool is_box(const Eigen::Matrix3d& m) {
  return m.allFinite() && m.diagonal().minCoeff() > 0 && m(1, 0) == 0 && m(2, 0) == 0 && m(2, 1) == 0;
}

}  // namespace

ReducedBox reduced_box(const Eigen::Matrix3d& vectors, double rounding) {
  if (!is_box(vectors)) return {{}, Box::flaw(vectors), ""};
  Eigen::Matrix3d m = vectors;
  std::string changes;
  // Brings the tilt of vector `from` along the edge of vector `other` to at most half that edge.
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
