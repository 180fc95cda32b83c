#pragma once

#include "forcefield/terms.hpp"
#include "md/system.hpp"

namespace taut {

// Of torsions. Force fields go to 6; a step takes as many products.
constexpr int kMostPeriodicity = 64;

// Throws InputError, one line naming the term and its index, for terms that do not fit the system.
void check_terms(const System& sys, const Terms& terms);

}  // namespace taut
