#include "base/course.hpp"

#include <algorithm>

namespace taut {

double Course::at(double t) const {
  if (t <= points_.front().t) return points_.front().value;
  if (t >= points_.back().t) return points_.back().value;
  const auto next = std::ranges::upper_bound(points_, t, {}, &Point::t);
  const auto& [t0, a] = *(next - 1);
  return a + (next->value - a) * (t - t0) / (next->t - t0);
}

// A step that ends at a point by rounding only ends there: so the trapezoidal rule is right across it.
double Course::rate(double t) const {
  constexpr double kRounding = 1e-9;
  const auto slope = [&](double at) {
    const auto next = std::ranges::upper_bound(points_, at, {}, &Point::t);
    if (next == points_.begin() || next == points_.end()) return 0.0;
    return (next->value - (next - 1)->value) / (next->t - (next - 1)->t);
  };
  return (slope(t - kRounding) + slope(t + kRounding)) / 2;
}

// The trapezoidal rule, exact between neighbouring points.
double Course::mean(double begin, double end) const {
  if (!(end > begin)) return at(end);
  double sum = 0, last = begin;
  const auto add = [&](double t) {
    if (!(t > last && t <= end)) return;
    sum += (t - last) * (at(last) + at(t)) / 2;
    last = t;
  };
  for (const Point& point : points_) add(point.t);
  add(end);
  return sum / (end - begin);
}

}  // namespace taut
