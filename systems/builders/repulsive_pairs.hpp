#pragma once

#include "forcefield/terms.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {

// Makes Lennard-Jones of all pairs its repulsive part, forcefield.pair = "wca". Pairs that are all alike become Terms::wca,
// those of several kinds a table each. Where no charges are left, Terms::nonbonded goes. Throws LocatedError.
void make_repulsive(const TomlTable& forcefield, Terms& terms);

}  // namespace taut
