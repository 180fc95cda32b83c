#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "md/box.hpp"

namespace taut {

// A region between two planes across an axis, or on one side of one; infinite where there is no plane.
struct Slab {
  int axis;
  double lower, upper;  // [nm]

  bool holds(const Vec3& x) const { return x[axis] > lower && x[axis] < upper; }
};

// The space of a box that spheres occupy, with radii up to `widest`. Spheres are numbered in the order in
// which they are added. A look-up takes a time that does not depend on their number.
class OccupiedSpace {
 public:
  // `rooms`: where atoms may be, between walls.
  OccupiedSpace(const Box& box, double widest, std::vector<Slab> rooms = {})
      : box_(box), cell_(std::max(2 * widest, 0.05)), rooms_(std::move(rooms)) {}

  bool is_between_walls(const Vec3& x) const {
    return std::ranges::all_of(rooms_, [&](const Slab& room) { return room.holds(x); });
  }

  // Returns whether a sphere at x overlaps no sphere n, except those for which may(n) is true. A negative radius lets
  // spheres overlap by as much.
  template <class May>
  bool is_free(const Vec3& x, double radius, May may) const {
    const Vec3 at = wrap(x);
    const Cell middle = cell_of(at);
    for (int n = 0; n < 27; ++n) {
      const auto found =
          cells_.find({middle[0] + n % 3 - 1, middle[1] + n / 3 % 3 - 1, middle[2] + n / 9 - 1});
      if (found == cells_.end()) continue;
      for (const Sphere& other : found->second) {
        const double touch = radius + other.radius;
        if (touch > 0 && (other.x - at).squaredNorm() < touch * touch && !may(other.n)) return false;
      }
    }
    return true;
  }
  bool is_free(const Vec3& x, double radius) const {
    return is_free(x, radius, [](int) { return false; });
  }

  void add(const Vec3& x, double radius);
  int size() const { return static_cast<int>(put_.size()); }
  void remove_from(int n);  // removes sphere n and all later ones

 private:
  using Cell = std::array<long, 3>;
  struct Hash {
    std::size_t operator()(const Cell& c) const {
      return static_cast<std::size_t>(c[0] * 73856093 ^ c[1] * 19349663 ^ c[2] * 83492791);
    }
  };
  struct Sphere {
    Vec3 x;
    double radius;
    int n;
  };

  Vec3 wrap(const Vec3& x) const;  // the image in the unit cell
  Cell cell_of(const Vec3& x) const;

  Box box_;
  double cell_;  // edge of a cell [nm], larger than the distance of any two overlapping spheres
  std::unordered_map<Cell, std::vector<Sphere>, Hash> cells_;
  std::vector<Slab> rooms_;
  std::vector<std::vector<Cell>> put_;  // the cells of each sphere and its images
};

}  // namespace taut
