#pragma once

#include "md/box.hpp"

namespace taut {

// Box::nearest_image for inner loops: no division and no call. Without a box it does nothing.
class NearestImage {
 public:
  explicit NearestImage(const Box& box) : edge_(box.edge) {
    if (box.periodic()) inv_edge_ = box.edge.cwiseInverse();
  }

  void operator()(double& dx, double& dy, double& dz) const {
    dx -= edge_[0] * round(dx * inv_edge_[0]);
    dy -= edge_[1] * round(dy * inv_edge_[1]);
    dz -= edge_[2] * round(dz * inv_edge_[2]);
  }

 private:
  // Adding 1.5·2⁵² pushes the fraction out of a double; right for |u| < 2⁵¹. Needs strict arithmetic
  // (no -ffast-math).
  static double round(double u) {
    constexpr double kShift = 6755399441055744.0;
    return (u + kShift) - kShift;
  }

  Vec3 edge_;                     // [nm]
  Vec3 inv_edge_ = Vec3::Zero();  // [1/nm]
};

}  // namespace taut
