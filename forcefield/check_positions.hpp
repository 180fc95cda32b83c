#pragma once

#include "base/vectors.hpp"
#include "md/box.hpp"

namespace taut {

// Throws SimulationFailure, which names the atom, for a position that is not finite or so far off that
// squares and their squares would not be: 1e15 nm, where numbers are an eighth of a nanometre apart.
void check_positions(const Vectors& x);

// Throws InputError, which names two atoms in one place, if there are any: no force between them has a direction.
void refuse_atoms_in_one_place(const Box& box, const Vectors& x);

}  // namespace taut
