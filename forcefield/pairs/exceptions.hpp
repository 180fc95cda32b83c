#pragma once

#include <vector>

#include "forcefield/terms.hpp"

namespace taut {

// Exceptions go by their own numbers: Lennard-Jones and plain 1/r, no cutoff and no images.

std::vector<PairException> interacting(const std::vector<PairException>& exceptions);  // those not all zeros

// Adds the forces to f and returns the energy [kJ/mol]. A plain loop, as those of bonded.hpp.
double add_exceptions(const std::vector<PairException>& exceptions, const Vectors& x, Vectors& f);

}  // namespace taut
