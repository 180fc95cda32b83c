#include "forcefield/external.hpp"

namespace taut {

double add_gravity(const Vec3& g, const Eigen::VectorXd& mass, const Vectors& x, Vectors& f) {
  double energy = 0;
  for (Eigen::Index i = 0; i < mass.size(); ++i) {
    energy -= mass[i] * g.dot(x.col(i));
    f.col(i) += mass[i] * g;
  }
  return energy;
}

double add_pulls(const std::vector<Pull>& pulls, const Vectors& x, Vectors& f) {
  double energy = 0;
  for (const auto& [atom, force] : pulls) {
    energy -= force.dot(x.col(atom));
    f.col(atom) += force;
  }
  return energy;
}

double add_restraints(const std::vector<Restraint>& restraints, const Box& box, const Vectors& x,
                      Vectors& f) {
  double energy = 0;
  for (const auto& [atom, at, k] : restraints) {
    const Vec3 off = box.nearest_image(x.col(atom) - at);
    energy += 0.5 * k * off.squaredNorm();
    f.col(atom) -= k * off;
  }
  return energy;
}

}  // namespace taut
