#pragma once

#include <string>

#include "forcefield/terms.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// Closed rings of bonds and springs, without their side chains, that go through each other: they cannot part unless a
// bond passes through another. Rings of fewer than eight atoms leave no room for another one and do not count, nor do
// rings that share atoms.
struct LinkedRings {
  int rings = 0, pairs = 0;                // pairs that are linked, each image of a ring counted apart
  int atom_of_one = 0, atom_of_other = 0;  // of the first pair
};
LinkedRings find_linked_rings(const System& sys, const Terms& terms, const State& s);

// Says how many are linked and what to do; empty if none is, or if no pair force keeps bonds from passing.
std::string linked_rings_message(const System& sys, const Terms& terms, const State& s);

}  // namespace taut
