#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "base/vectors.hpp"

namespace taut {

// The dihedral φ of four atoms (0 cis, IUPAC sign) and its gradient, after Blondel and Karplus 1996
// (doi:10.1002/(SICI)1096-987X(19960715)17:9<1132::AID-JCC5>3.0.CO;2-T). With F = x_i − x_j,
// G = x_j − x_k, H = x_l − x_k, A = F × G, B = H × G:
//     cos φ ∝ A·B,  sin φ ∝ (B × A)·G/|G|,  ∂φ/∂x_i = −|G|A/A²,  ∂φ/∂x_l = |G|B/B²,
//     ∂φ/∂x_j = −∂φ/∂x_i + S,  ∂φ/∂x_k = −∂φ/∂x_l − S,  S = (F·G A/A² − H·G B/B²)/|G|.
// φ is undefined where an end atom lies on the axis G (sin² of the angle there up to 1e-20): φ and its
// gradient are then 0.
struct Dihedral {
  double phi = 0;
  Vec3 grad_i = Vec3::Zero(), grad_j = grad_i, grad_k = grad_i, grad_l = grad_i;  // [rad/nm]

  Dihedral(const Vec3& xi, const Vec3& xj, const Vec3& xk, const Vec3& xl) {
    const Vec3 F = xi - xj, G = xj - xk, H = xl - xk;
    const Vec3 A = F.cross(G), B = H.cross(G);
    const double g2 = G.squaredNorm(), g = std::sqrt(g2), a2 = A.squaredNorm(), b2 = B.squaredNorm();
    if (a2 <= 1e-20 * g2 * F.squaredNorm() || b2 <= 1e-20 * g2 * H.squaredNorm()) return;
    phi = std::atan2(B.cross(A).dot(G), A.dot(B) * g);
    const Vec3 a = A / a2, b = B / b2;
    const Vec3 s = (F.dot(G) * a - H.dot(G) * b) / g;
    grad_i = -g * a;
    grad_l = g * b;
    grad_j = s - grad_i;
    grad_k = -s - grad_l;
  }
};

}  // namespace taut
