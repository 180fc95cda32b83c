#pragma once

#include "md/vectors.hpp"

namespace taut {

// A rectangular periodic box, or none.
struct Box {
  Vec3 edge = Vec3::Zero();  // [nm]; zero: no box

  bool periodic() const { return edge.x() > 0; }
  double volume() const { return edge.prod(); }  // [nm³]

  // The shortest of the images of a separation d [nm]. Without a box, d itself.
  Vec3 nearest_image(const Vec3& d) const {
    if (!periodic()) return d;
    return d - edge.cwiseProduct(d.cwiseQuotient(edge).array().round().matrix());
  }
};

}  // namespace taut
