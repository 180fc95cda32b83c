#pragma once

#include "forcefield/terms.hpp"
#include "md/box.hpp"
#include "md/system.hpp"

namespace taut {

// Of torsions. Force fields go to 6; a step takes as many products.
constexpr int kMostPeriodicity = 64;

// Throws InputError, one line naming the term and its index, for terms that do not fit the system or
// the box.
void check_terms(const System& sys, const Box& box, const Terms& terms);

// The part of it that a box may lose as it shrinks: throws InputError for a cutoff over half its shortest
// edge.
void check_room(const Terms& terms, const Box& box);

}  // namespace taut
