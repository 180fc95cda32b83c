#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "md/box.hpp"

namespace taut {

// Which places of a box are taken: by spheres that may touch, of radii up to `widest`. Spheres are counted in
// the order they were put there. Looking one up takes a time that does not grow with their number.
class Room {
 public:
  Room(const Box& box, double widest) : box_(box), cell_(std::max(2 * widest, 0.05)) {}

  // Whether a sphere at x overlaps none of them but those that may: may(n) says it of the n-th.
  template <class May>
  bool free(const Vec3& x, double radius, May may) const {
    const Vec3 at = home(x);
    const Cell middle = cell_of(at);
    for (int n = 0; n < 27; ++n) {
      const auto found =
          cells_.find({middle[0] + n % 3 - 1, middle[1] + n / 3 % 3 - 1, middle[2] + n / 9 - 1});
      if (found == cells_.end()) continue;
      for (const Sphere& other : found->second) {
        const double touch = radius + other.radius;
        if ((other.x - at).squaredNorm() < touch * touch && !may(other.n)) return false;
      }
    }
    return true;
  }
  bool free(const Vec3& x, double radius) const {
    return free(x, radius, [](int) { return false; });
  }

  void take(const Vec3& x, double radius);
  int taken() const { return static_cast<int>(put_.size()); }
  void release(int n);  // the n-th and all after it

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

  Vec3 home(const Vec3& x) const;  // its image in the brick from the origin on
  Cell cell_of(const Vec3& x) const;

  Box box_;
  double cell_;  // [nm]: wider than any two spheres that overlap are apart
  std::unordered_map<Cell, std::vector<Sphere>, Hash> cells_;
  std::vector<std::vector<Cell>> put_;  // of each sphere, the cells it and its images are in
};

}  // namespace taut
