#pragma once

#include "base/vectors.hpp"

namespace taut {

// Throws SimulationFailure, which names the atom, for a position that is not finite or so far off that
// squares and their squares would not be: 1e15 nm, where numbers are an eighth of a nanometre apart.
void check_positions(const Vectors& x);

}  // namespace taut
