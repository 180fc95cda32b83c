// In minimisation held bonds are springs, U = k (r − d)²: a constraint's direction changes on the way down,
// which a line search does not bear.

#include <algorithm>
#include <cmath>

#include "lammps/fix_taut.hpp"

namespace LAMMPS_NS {

// The stiffness that `kbond` gives, or fix shake's: 10⁹ times Boltzmann's constant. The minimisers fire and
// quickmin integrate with steps of up to ten times `timestep`: for them the springs are at most so stiff that no
// oscillation turns by more than 0.2 radians a step. Springs of energy k r² at atoms of mass m, b of them an
// atom, oscillate with ω² ≤ 2k · 2b/m.
void FixTaut::choose_stiffness() {
  constexpr double kAsShake = 1e9, kLongest = 10, kPhase = 0.2;
  stiffness_ = keys_.restraint > 0 ? keys_.restraint : kAsShake * force->boltz;
  const char* const minimiser = update->minimize_style;
  if (keys_.restraint > 0 ||
      !(utils::strmatch(minimiser, "^fire") || utils::strmatch(minimiser, "^quickmin")))
    return;
  double lightest = 1e300;  // mass over number of bonds
  for (int i = 0; i < atom->nlocal; ++i)
    if (held_.count(i) > 0) lightest = std::min(lightest, mass(i) / held_.count(i));
  const double rate = kPhase / (kLongest * update->dt);
  stiffness_ = std::min(stiffness_, -all_max(-lightest) * rate * rate / (4 * force->ftm2v));
}

void FixTaut::min_post_force(int vflag) {
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
      const double stretch = length - lengths_(bond.kind), pull = 2 * stiffness_ * stretch / length;
      for (int c = 0; c < 3; ++c) atom->f[i][c] += pull * r[c];
      restraint_energy_ += 0.5 * stiffness_ * stretch * stretch;  // the other half is the partner's
      if (!evflag) continue;
      double v[6] = {r[0] * r[0], r[1] * r[1], r[2] * r[2], r[0] * r[1], r[0] * r[2], r[1] * r[2]};
      for (double& component : v) component *= -pull;
      v_tally(1, &i, 2.0, v);
    }
}

}  // namespace LAMMPS_NS
