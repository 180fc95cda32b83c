#pragma once

#include "md/system.hpp"

namespace taut {

// Motions of all atoms that move as of one body, v = u + ω × (x − c). The momentum that belongs to one, Σ m v·(u + ω
// × (x − c)), is conserved where nothing outside acts on them and the motion leaves every anchor where it is:
// translations where there is no anchor, rotations about what anchors there are where there is no box. Each that is
// held at zero is a degree of freedom less.
class RigidMotions {
 public:
  enum class Which { kNone, kTranslations, kAllThatMoveNoAnchor };
  using Metric = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;  // Σ m e·e' of motions e

  RigidMotions() = default;  // none
  RigidMotions(Which which, const System& sys, const Vectors& x);

  int count() const { return static_cast<int>(basis_.cols()); }
  Metric nothing() const { return Metric::Zero(count(), count()); }
  Metric of_mass(double mass, const Vec3& x) const;         // at x
  Metric of_turning(const Eigen::Matrix3d& inertia) const;  // about a centre of its own
  Metric of_all(const System& sys, const Vectors& x) const;
  bool at_zero(const System& sys, const Vectors& x,
               const Vectors& v) const;  // all their momenta, but for rounding

 private:
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 6> at(const Vec3& x) const;

  Vec3 centre_ = Vec3::Zero();
  double size_ = 1;                                                // of ω's, that they weigh as u's [nm]
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6> basis_{6, 0};  // u and ω·size of each
};

// The inverse of a metric on the motions that have one: turning a line about itself has none.
struct InverseMetric {
  explicit InverseMetric(const RigidMotions::Metric& metric);

  RigidMotions::Metric inverse;
  int rank = 0;  // how many motions are independent
};

}  // namespace taut
