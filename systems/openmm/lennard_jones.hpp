#pragma once

#include <optional>
#include <vector>

#include "systems/openmm/forces.hpp"

namespace taut {

// The Lennard-Jones forces that openmm.app adds to a NonbondedForce of charges for CHARMM's special pairs
// (NBFIX), its 1–4 pairs, or another mixing rule: a CustomNonbondedForce of types and a CustomBondForce of
// pairs. Both become part of the Nonbonded. Throws InputError, to which the caller adds the force, if that
// would change the energy of a pair.

// `types` has a table and exclusions. If the table follows from σ and ε by the Lorentz–Berthelot rule, they
// replace it.
void add_lennard_jones(Nonbonded types, std::optional<Nonbonded>& to);

// Takes a reaction field between excluded charges and of each on itself, if it is that which follows from `to`.
void add_excluded_field(const std::vector<ExcludedCharges>& field, std::optional<Nonbonded>& to);

// Adds the pairs to the exceptions of `to`.
void add_pairs(const std::vector<PairException>& pairs, std::optional<Nonbonded>& to);

}  // namespace taut
