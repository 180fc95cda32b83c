#pragma once

#include <utility>
#include <vector>

namespace taut {

// A number that changes in time along straight lines between given points: constant before the first point and after
// the last.
class Course {
 public:
  struct Point {
    double t, value;
    bool operator==(const Point& other) const { return t == other.t && value == other.value; }
  };

  Course() = default;
  explicit Course(std::vector<Point> points) : points_(std::move(points)) {}

  bool empty() const { return points_.empty(); }
  const std::vector<Point>& points() const { return points_; }
  double at(double t) const;
  double rate(double t) const;                  // of change; at a point, the mean of both lines' [1/time]
  double mean(double begin, double end) const;  // over a stretch of time
  bool operator==(const Course& other) const { return points_ == other.points_; }

 private:
  std::vector<Point> points_;  // by rising t
};

}  // namespace taut
