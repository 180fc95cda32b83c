#pragma once

#include <optional>
#include <vector>

#include "forcefield/terms.hpp"

namespace taut {

// Lennard-Jones that openmm.app puts beside a NonbondedForce of charges, for CHARMM's special pairs (NBFIX),
// its 1-4 pairs or another rule of mixing: a CustomNonbondedForce of types, and a CustomBondForce of pairs.
// Both become part of the Nonbonded. Where that would give a pair another law, InputError is thrown, to be
// said of the force.

// `types` has a table and plain exclusions. Where the table is what Lorentz and Berthelot's rule makes of σ
// and ε, these take its place.
void add_lennard_jones(Nonbonded types, std::optional<Nonbonded>& to);

// The pairs are exceptions of `to`.
void add_pairs(const std::vector<PairException>& pairs, std::optional<Nonbonded>& to);

}  // namespace taut
