#include "constraints/bond_algebra.hpp"

namespace taut {

void bond_vectors(const System& sys, const Vectors& x, Vectors& r) {
  if (!sys.images.periodic()) return differences(sys, x, r);
  for (int k = 0; k < r.cols(); ++k) r.col(k) = sys.along(sys.bond(k), x);
}

void differences(const System& sys, const Vectors& x, Vectors& r) {
  for (int k = 0; k < r.cols(); ++k) r.col(k) = sys.difference(sys.bond(k), x);
}

void add_constraint_force(const System& sys, const Vectors& r, const Eigen::VectorXd& lambda, Vectors& f) {
  for (int k = 0; k < r.cols(); ++k) {
    const Vec3 pull = lambda[k] * r.col(k);
    sys.for_each_bearer(sys.bond(k), [&](int a, double c) { f.col(a) += c * pull; });
  }
}

void add_constraint_acceleration(const System& sys, const Vectors& r, const Eigen::VectorXd& lambda,
                                 Vectors& y) {
  for (int k = 0; k < r.cols(); ++k) add_constraint_acceleration(sys, k, lambda[k] * r.col(k), y);
}

Eigen::VectorXd tensions(const System& sys, const Eigen::VectorXd& lambda) {
  Eigen::VectorXd t(sys.bond_count());
  for (int k = 0; k < sys.bond_count(); ++k) t[k] = -lambda[k] * sys.bonds[k].length;
  return t;
}

}  // namespace taut
