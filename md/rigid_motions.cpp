#include "md/rigid_motions.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "md/observables.hpp"

namespace taut {
namespace {

constexpr double kNone = 1e-9;     // of the largest eigenvalue
constexpr double kAtZero = 1e-12;  // of the kinetic energy

using Matrix6 = Eigen::Matrix<double, 6, 6>;

Eigen::Matrix3d cross(const Vec3& d) {
  Eigen::Matrix3d m;
  m << 0, -d.z(), d.y(), d.z(), 0, -d.x(), -d.y(), d.x(), 0;
  return m;
}

// How far atoms that are no sites are from their centre, root mean square.
double spread(const System& sys, const Vectors& x, Vec3& centre) {
  int count = 0;
  Vec3 sum = Vec3::Zero();
  double squares = 0;
  for (int a = 0; a < sys.atoms(); ++a)
    if (!sys.is_site(a)) ++count, sum += x.col(a);
  centre = sum / std::max(1, count);
  for (int a = 0; a < sys.atoms(); ++a)
    if (!sys.is_site(a)) squares += (x.col(a) - centre).squaredNorm();
  return squares > 0 ? std::sqrt(squares / count) : 1.0;
}

}  // namespace

RigidMotions::RigidMotions(Which which, const System& sys, const Vectors& x) {
  size_ = spread(sys, x, centre_);
  if (which == Which::kNone) return;
  if (which == Which::kTranslations) {
    basis_ = Matrix6::Identity().leftCols(3);
    return;
  }
  basis_ = Matrix6::Identity();
  Matrix6 of_anchors = Matrix6::Zero();
  for (int a = 0; a < sys.atoms(); ++a)
    if (sys.is_anchor(a)) of_anchors += of_mass(1, x.col(a));
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(of_anchors);
  const int still = static_cast<int>((solver.eigenvalues().array() <= kNone * sys.anchors()).count());
  basis_ = solver.eigenvectors().leftCols(still);
}

Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 6> RigidMotions::at(const Vec3& x) const {
  return basis_.topRows<3>() - cross((x - centre_) / size_) * basis_.bottomRows<3>();
}

RigidMotions::Metric RigidMotions::of_mass(double mass, const Vec3& x) const {
  const auto e = at(x);
  return mass * e.transpose() * e;
}

RigidMotions::Metric RigidMotions::of_turning(const Eigen::Matrix3d& inertia) const {
  return basis_.bottomRows<3>().transpose() * inertia * basis_.bottomRows<3>() / (size_ * size_);
}

RigidMotions::Metric RigidMotions::of_all(const System& sys, const Vectors& x) const {
  Metric all = nothing();
  for (int a = 0; a < sys.atoms(); ++a)
    if (sys.mass[a] > 0) all += of_mass(sys.mass[a], x.col(a));
  return all;
}

// p = Σ m e·v: p·G⁻¹p is twice the kinetic energy of what moves so, G the metric.
bool RigidMotions::at_zero(const System& sys, const Vectors& x, const Vectors& v) const {
  Eigen::VectorXd p = Eigen::VectorXd::Zero(count());
  for (int a = 0; a < sys.atoms(); ++a) p += sys.mass[a] * at(x.col(a)).transpose() * v.col(a);
  return p.dot(InverseMetric(of_all(sys, x)).inverse * p) <= kAtZero * 2 * kinetic_energy(sys, v);
}

InverseMetric::InverseMetric(const RigidMotions::Metric& metric) : inverse(metric) {
  if (metric.size() == 0) return;
  const Eigen::SelfAdjointEigenSolver<RigidMotions::Metric> solver(metric);
  const auto& values = solver.eigenvalues();
  inverse.setZero();
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    if (!(values[k] > kNone * values[values.size() - 1])) continue;
    inverse += solver.eigenvectors().col(k) * solver.eigenvectors().col(k).transpose() / values[k];
    ++rank;
  }
}

}  // namespace taut
