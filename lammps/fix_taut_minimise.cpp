// In minimisation held bonds are springs, U = k (r − d)²: a constraint's direction changes on the way down,
// which a line search does not bear.

#include <cmath>

#include "lammps/fix_taut.hpp"

namespace LAMMPS_NS {

void FixTaut::min_post_force(int vflag) {
  constexpr double kAsShake = 1e9;  // times Boltzmann's constant, an energy over length²
  const double stiffness = keys_.restraint > 0 ? keys_.restraint : kAsShake * force->boltz;
  v_init(vflag);
  restraint_energy_ = 0;
  for (int i = 0; i < atom->nlocal; ++i)
    for (const taut::HeldBond& bond : held_.of(i)) {
      const int partner = atom->map(bond.partner);
      if (partner < 0) stop(missing_partner(atom->tag[i], bond.partner));
      double r[3];
      for (int c = 0; c < 3; ++c) r[c] = atom->x[partner][c] - atom->x[i][c];
      taut::minimum_image(*domain, r);
      const double length = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
      const double stretch = length - lengths_(bond.kind), pull = 2 * stiffness * stretch / length;
      for (int c = 0; c < 3; ++c) atom->f[i][c] += pull * r[c];
      restraint_energy_ += 0.5 * stiffness * stretch * stretch;  // the other half is the partner's
      if (!evflag) continue;
      double v[6] = {r[0] * r[0], r[1] * r[1], r[2] * r[2], r[0] * r[1], r[0] * r[2], r[1] * r[2]};
      for (double& component : v) component *= -pull;
      v_tally(1, &i, 2.0, v);
    }
}

}  // namespace LAMMPS_NS
