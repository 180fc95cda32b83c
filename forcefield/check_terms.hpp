#pragma once

#include "forcefield/terms.hpp"
#include "md/system.hpp"

namespace taut {

// Throws InputError, one line naming the term and its index, for terms that do not fit the system.
void check_terms(const System& sys, const Terms& terms);

}  // namespace taut
