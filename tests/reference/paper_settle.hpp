#pragma once

#include <cmath>

#include "constraints/methods/settle.hpp"

namespace taut::tests {

// SETTLE as its paper has it, water by water: the witness of constraints/methods/settle.cpp.
class PaperSettle : public ConstraintMethod {
 public:
  explicit PaperSettle(const System& sys)
      : waters_(Settle::find_waters(sys)), lambda_(Eigen::VectorXd::Zero(sys.bond_count())) {}

  SolveStats project_positions(const System& sys, double h, State& s) override {
    for (const Settle::Water& water : waters_)
      if (!reset(water, sys, h, s)) return {1, 0, water.bonds[0], Failure::kShapeLost};
    return {1};
  }

  // A g = −J v, v += M⁻¹Jᵀg, with J of one water
  SolveStats project_velocities(const System& sys, double h, State& s) override {
    for (const Settle::Water& water : waters_) {
      const int atoms[] = {water.apex, water.left, water.right}, ends[3][2] = {{0, 1}, {0, 2}, {1, 2}};
      Eigen::Matrix<double, 3, 9> J = Eigen::Matrix<double, 3, 9>::Zero();
      Eigen::Vector<double, 9> v, w;
      for (int a = 0; a < 3; ++a) {
        v.segment<3>(3 * a) = s.v.col(atoms[a]);
        w.segment<3>(3 * a).setConstant(sys.inv_mass[atoms[a]]);
      }
      for (int k = 0; k < 3; ++k) {
        const auto& [i, j] = ends[k];
        J.block<1, 3>(k, 3 * j) = (s.x.col(atoms[j]) - s.x.col(atoms[i])).transpose();
        J.block<1, 3>(k, 3 * i) = -J.block<1, 3>(k, 3 * j);
      }
      const Eigen::Matrix3d A = J * w.asDiagonal() * J.transpose();
      const Vec3 g = A.ldlt().solve(-J * v);
      v += w.asDiagonal() * J.transpose() * g;
      for (int a = 0; a < 3; ++a) s.v.col(atoms[a]) = v.segment<3>(3 * a);
      for (int k = 0; k < 3; ++k) lambda_[water.bonds[k]] = 2 / h * g[k];
    }
    return {1};
  }

  const Eigen::VectorXd& lambda() const override { return lambda_; }

 private:
  // Names follow the paper: 0 is before the step, 1 after the drift, 2 after the rotations φ and ψ, 3 after θ.
  // The axes X'Y'Z' have their origin at the drifted centre of mass, Z' along the normal of the old triangle,
  // and the drifted apex in the plane Y'Z'. Returns false if no rotation exists because the drifted triangle
  // lies too far from the old one.
  static bool reset(const Settle::Water& w, const System& sys, double h, State& s) {
    const double ma = sys.mass[w.apex], mh = sys.mass[w.left], inv_total = 1 / (ma + 2 * mh);
    const Vec3 a_new = s.x.col(w.apex), b_new = s.x.col(w.left), c_new = s.x.col(w.right);
    const Vec3 v_a = s.v.col(w.apex);
    const Vec3 b0 = b_new - a_new - h * (s.v.col(w.left) - v_a),
               c0 = c_new - a_new - h * (s.v.col(w.right) - v_a);
    // Positions relative to the apex, so that no large numbers are subtracted.
    const Vec3 centre = mh * inv_total * ((b_new - a_new) + (c_new - a_new));
    const Vec3 a1 = -centre, b1 = b_new - a_new - centre, c1 = c_new - a_new - centre;

    const Vec3 z = b0.cross(c0).normalized(), x = a1.cross(z).normalized(), y = z.cross(x);
    const double xb0 = x.dot(b0), yb0 = y.dot(b0), xc0 = x.dot(c0), yc0 = y.dot(c0);
    const double za1 = z.dot(a1);
    const double xb1 = x.dot(b1), yb1 = y.dot(b1), zb1 = z.dot(b1);
    const double xc1 = x.dot(c1), yc1 = y.dot(c1), zc1 = z.dot(c1);

    const double sin_phi = za1 / w.ra, cos_phi = std::sqrt(1 - sin_phi * sin_phi);
    const double sin_psi = (zb1 - zc1) / (2 * w.rc * cos_phi), cos_psi = std::sqrt(1 - sin_psi * sin_psi);
    const double ya2 = w.ra * cos_phi, xb2 = -w.rc * cos_psi;
    const double yb2 = -w.rb * cos_phi - w.rc * sin_psi * sin_phi,
                 yc2 = -w.rb * cos_phi + w.rc * sin_psi * sin_phi;

    const double alpha = xb2 * (xb0 - xc0) + yb0 * yb2 + yc0 * yc2;
    const double beta = xb2 * (yc0 - yb0) + xb0 * yb2 + xc0 * yc2;
    const double gamma = xb0 * yb1 - xb1 * yb0 + xc0 * yc1 - xc1 * yc0;
    const double norm = alpha * alpha + beta * beta;
    const double sin_theta = (alpha * gamma - beta * std::sqrt(norm - gamma * gamma)) / norm;
    const double cos_theta = std::sqrt(1 - sin_theta * sin_theta);
    if (!(std::isfinite(sin_theta) && std::isfinite(cos_theta) && std::isfinite(cos_psi))) return false;

    const Vec3 a3 = -ya2 * sin_theta * x + ya2 * cos_theta * y + za1 * z;
    const Vec3 b3 =
        (xb2 * cos_theta - yb2 * sin_theta) * x + (xb2 * sin_theta + yb2 * cos_theta) * y + zb1 * z;
    const Vec3 c3 =
        (-xb2 * cos_theta - yc2 * sin_theta) * x + (-xb2 * sin_theta + yc2 * cos_theta) * y + zc1 * z;

    const auto move = [&](int atom, const Vec3& shift) {
      s.x.col(atom) += shift;
      s.v.col(atom) += shift / h;
    };
    move(w.apex, a3 - a1);
    move(w.left, b3 - b1);
    move(w.right, c3 - c1);
    return true;
  }

  std::vector<Settle::Water> waters_;
  Eigen::VectorXd lambda_;  // m
};

}  // namespace taut::tests
