#pragma once

#include <cmath>
#include <string>

#include "base/vectors.hpp"

namespace taut {

// A periodic box, or none: the lattice of
//     a = (a_x, 0, 0),   b = (b_x, b_y, 0),   c = (c_x, c_y, c_z),
// in OpenMM's reduced form: a_x, b_y, c_z > 0, |b_x| and |c_x| ≤ a_x/2, |c_y| ≤ b_y/2. A rectangular box has
// no tilt.
//
// The rectangular unit cell a_x × b_y × c_z fills space by the same lattice as the parallelepiped does, its
// layers displaced by the tilts. Every separation has one image in the cell about the origin. Where that
// image is at most half the shortest edge long, no other image is shorter: this is all that a cutoff needs.
struct Box {
  Vec3 edge = Vec3::Zero();  // a_x, b_y, c_z [nm]; zero: no box
  Vec3 tilt = Vec3::Zero();  // b_x, c_x, c_y [nm]

  bool periodic() const { return edge.x() > 0; }
  double volume() const { return edge.prod(); }  // [nm³]

  // n₁a + n₂b + n₃c
  Vec3 lattice_vector(const Vec3& n) const {
    return {n.x() * edge.x() + n.y() * tilt.x() + n.z() * tilt.y(), n.y() * edge.y() + n.z() * tilt.z(),
            n.z() * edge.z()};
  }

  // The n of the unit cell that holds d. With std::floor cell 0 has its corner at the origin, with std::round
  // its centre.
  Vec3 cell_of(const Vec3& d, double (*whole)(double)) const {
    const double c = whole(d.z() / edge.z());
    const double b = whole((d.y() - c * tilt.z()) / edge.y());
    const double a = whole((d.x() - c * tilt.y() - b * tilt.x()) / edge.x());
    return {a, b, c};
  }

  // The image of a separation d in the unit cell about the origin [nm]. Without a box, d itself.
  Vec3 nearest_image(const Vec3& d) const {
    if (!periodic()) return d;
    return d - lattice_vector(cell_of(d, std::round));
  }

  // x = s₁a + s₂b + s₃c
  Vec3 fractional(const Vec3& x) const {
    const double c = x.z() / edge.z(), b = (x.y() - c * tilt.z()) / edge.y();
    return {(x.x() - c * tilt.y() - b * tilt.x()) / edge.x(), b, c};
  }
  // Σ g ∇s: turns derivatives g by a, b and c into derivatives by x, y and z. Of whole numbers g it makes a
  // wave vector [1/nm].
  Vec3 reciprocal(const Vec3& g) const {
    const double x = g.x() / edge.x(), y = (g.y() - tilt.x() * x) / edge.y();
    return {x, y, (g.z() - tilt.y() * x - tilt.z() * y) / edge.z()};
  }

  // Multiplies all lengths along x, y and z by `by`. The box stays in reduced form.
  Box scaled(const Vec3& by) const {
    return {edge.cwiseProduct(by), tilt.cwiseProduct(Vec3(by.x(), by.x(), by.y()))};
  }

  // a, b and c as columns [nm].
  Eigen::Matrix3d vectors() const;
  // Says why vectors are no box in reduced form, and what was expected; empty where they are one.
  static std::string flaw(const Eigen::Matrix3d& vectors);
  static Box of(const Eigen::Matrix3d& vectors);  // of vectors without a flaw

  template <class In>
  void serialize(In& archive) {
    const bool before = periodic();
    archive(edge, tilt);
    archive.demand(periodic() == before && (!before || flaw(vectors()).empty()));
  }

  friend bool operator==(const Box& a, const Box& b) { return a.edge == b.edge && a.tilt == b.tilt; }
  friend bool operator!=(const Box& a, const Box& b) { return !(a == b); }
};

}  // namespace taut
