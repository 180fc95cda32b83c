#include "forcefield/pairs/exceptions.hpp"

#include <cmath>

#include "md/units.hpp"

namespace taut {

std::vector<PairException> interacting(const std::vector<PairException>& exceptions) {
  std::vector<PairException> some;
  for (const auto& e : exceptions)
    if (e.charge_product != 0 || e.epsilon != 0) some.push_back(e);
  return some;
}

// E = 4ε((σ/r)¹² − (σ/r)⁶) + k qq/r
double add_exceptions(const std::vector<PairException>& exceptions, const Vectors& x, Vectors& f) {
  double energy = 0;
  for (const auto& e : exceptions) {
    const Vec3 d = x.col(e.i) - x.col(e.j);
    const double inv_r2 = 1 / d.squaredNorm();
    const double s2 = e.sigma * e.sigma * inv_r2, s6 = s2 * s2 * s2;
    const double coulomb = kCoulomb * e.charge_product * std::sqrt(inv_r2);
    energy += 4 * e.epsilon * (s6 - 1) * s6 + coulomb;
    const Vec3 push = (4 * e.epsilon * (12 * s6 - 6) * s6 + coulomb) * inv_r2 * d;
    f.col(e.i) += push;
    f.col(e.j) -= push;
  }
  return energy;
}

}  // namespace taut
