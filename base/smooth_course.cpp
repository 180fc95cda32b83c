#include "base/smooth_course.hpp"

#include <algorithm>
#include <utility>

namespace taut {

// On each interval, of length Δ and mean velocity m = Δy/Δ, the cubic has given places and velocities u at its ends. Its
// second derivative is continuous where
//     u_{i−1}/Δ_{i−1} + 2u_i (1/Δ_{i−1} + 1/Δ_i) + u_{i+1}/Δ_i = 3 (m_{i−1}/Δ_{i−1} + m_i/Δ_i),   u = 0 at both ends,
// which is solved by elimination from the first row to the last.
SmoothCourse::SmoothCourse(std::vector<Point> points) : points_(std::move(points)) {
  const std::size_t n = points_.size();
  const auto inverse = [&](std::size_t i) { return 1 / (points_[i + 1].t - points_[i].t); };
  std::vector<double> above(n, 0.0);
  velocity_.assign(n, Vec3::Zero());
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = inverse(i - 1), after = inverse(i);
    const Vec3 right = 3 * (before * before * (points_[i].place - points_[i - 1].place) +
                            after * after * (points_[i + 1].place - points_[i].place));
    const double pivot = 2 * (before + after) - before * above[i - 1];
    above[i] = after / pivot;
    velocity_[i] = (right - before * velocity_[i - 1]) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 1;) velocity_[i] -= above[i] * velocity_[i + 1];
}

SmoothCourse::Motion SmoothCourse::at(double t) const {
  Motion still{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  if (empty()) return still;
  const auto next = std::ranges::upper_bound(points_, t, {}, &Point::t);
  if (next == points_.begin() || next == points_.end()) {
    still.place = (next == points_.begin() ? points_.front() : points_.back()).place;
    return still;
  }
  const std::size_t i = static_cast<std::size_t>(next - points_.begin()) - 1;
  const double length = next->t - points_[i].t, s = t - points_[i].t;
  const Vec3 mean = (next->place - points_[i].place) / length, u = velocity_[i], w = velocity_[i + 1];
  const Vec3 c = (3 * mean - 2 * u - w) / length, d = (u + w - 2 * mean) / (length * length);
  return {points_[i].place + s * (u + s * (c + s * d)), u + s * (2 * c + 3 * s * d), 2 * c + 6 * s * d};
}

}  // namespace taut
