#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross products

namespace taut {

using Vec3 = Eigen::Vector3d;
using Vectors = Eigen::Matrix3Xd;  // 3 × n, column i = atom i (or bond i)

}  // namespace taut
