#pragma once

#include "forcefield/terms.hpp"

namespace taut {

// The energy of the Lennard-Jones tails beyond the cutoff (and of what the switch took away), if the fluid
// were uniform there, times the volume [kJ/mol·nm³]. Divide by the volume; there is no force.
// Needs nb.cutoff.
double dispersion_coefficient(const Nonbonded& nb);

// A third of their virial times the volume [kJ/mol·nm³]. It is the energy, which goes as 1/V; and where pairs
// end at a plain cutoff, by a jump that is in no force, the push of those that cross it.
double dispersion_virial_coefficient(const Nonbonded& nb);

// ∫ (1 − S(r)) r⁻ⁿ dr to infinity, S the switch from rs to rc, or at rs = rc the plain cutoff; n = 4 or more.
// [nm¹⁻ⁿ]
double cut_tail(double rs, double rc, int n);

}  // namespace taut
