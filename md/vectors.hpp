#pragma once

#include <Eigen/Core>

namespace taut {

using Vec3 = Eigen::Vector3d;
using Vectors = Eigen::Matrix3Xd;  // 3 × n, column i = atom i (or bond i)

}  // namespace taut
