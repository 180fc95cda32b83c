#pragma once

#include <string>

#include "forcefield/terms.hpp"
#include "md/box.hpp"
#include "md/system.hpp"

namespace taut {

// Of torsions. Force fields go to 6; a step takes as many products.
constexpr int kMostPeriodicity = 64;

// Of a table of Lennard-Jones. Pairs find their place in it, with a type more for atoms that have none, by 22
// bits.
constexpr int kMostTypes = 2047;

// Throws InputError, one line naming the term and its index, for terms that do not fit the system or
// the box.
void check_terms(const System& sys, const Box& box, const Terms& terms);

// The part of it that a box may lose as it shrinks: what is wrong with a cutoff over half its shortest edge;
// empty: nothing.
std::string lack_of_room(const Terms& terms, const Box& box);

}  // namespace taut
