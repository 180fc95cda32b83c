#include "ensembles/pressure.hpp"

namespace taut {

Eigen::Matrix3d pressure(const System& sys, ForceField& forces, const State& at,
                         const ForceField::Evaluation& evaluation, const Eigen::VectorXd& lambda) {
  const Vectors &x = at.x, &v = at.v;
  Eigen::Matrix3d sum = forces.virial(at, evaluation) + v * sys.mass.asDiagonal() * v.transpose();
  for (int k = 0; k < sys.bond_count(); ++k) {
    const Vec3 r = sys.along(sys.bonds[k], x);
    sum += lambda[k] * r * r.transpose();
  }
  return kBarPerUnit / at.box.volume() * sum;
}

}  // namespace taut
