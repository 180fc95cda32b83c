#pragma once

#include <vector>

#include "base/vectors.hpp"

namespace taut {

// A way through given places at given times, along the cubic spline that is at rest at both ends (clamped: de Boor 1978,
// A Practical Guide to Splines). It stands still before the first and after the last time, so that place and velocity
// are continuous everywhere, the acceleration between the ends.
class SmoothCourse {
 public:
  struct Point {
    double t;
    Vec3 place;
  };
  struct Motion {
    Vec3 place, velocity, acceleration;
  };

  SmoothCourse() = default;                          // empty: it stands at the origin
  explicit SmoothCourse(std::vector<Point> points);  // at least two, by rising t

  bool empty() const { return points_.empty(); }
  Motion at(double t) const;

 private:
  std::vector<Point> points_;
  std::vector<Vec3> velocity_;  // at the points
};

}  // namespace taut
