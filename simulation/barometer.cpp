#include "simulation/barometer.hpp"

#include "md/observables.hpp"

namespace taut {

Barometer::Barometer(const System& sys, bool springs) : springs_(springs), projector_(sys) {}

double Barometer::operator()(const System& sys, ForceField& forces, const Vectors& x, const Vectors& v,
                             const Eigen::VectorXd& spring_lambda) {
  now_.x = x;
  now_.v = v;
  forces(sys, now_);
  const Eigen::VectorXd& lambda = springs_ ? spring_lambda : projector_.multipliers(sys, now_);
  double bonds = 0;
  for (int k = 0; k < sys.bond_count(); ++k)
    bonds += lambda[k] * (x.col(sys.bonds[k].j) - x.col(sys.bonds[k].i)).squaredNorm();
  const double virial = forces.virial(x) + bonds;
  return kBarPerUnit * (2 * kinetic_energy(sys, v) + virial) / (3 * sys.box.volume());
}

}  // namespace taut
