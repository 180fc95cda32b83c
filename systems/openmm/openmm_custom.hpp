#pragma once

// The terms OpenMM has no class for, as custom forces whose expressions are fixed here, and read back by
// them. For the exporter and the importer only.

#include <OpenMM.h>

#include "forcefield/terms.hpp"
#include "md/system.hpp"

namespace taut {

// Gravity, pulls, FENE springs and WCA beads, as far as `terms` has them.
void write_custom_forces(const System& sys, const Terms& terms, OpenMM::System& to);

// Adds a custom force that write_custom_forces could have written to `terms`; false for what is no custom
// force. Throws InputError, saying what of it taut does not have ("has the energy ...").
bool read_custom_force(const OpenMM::Force& force, const System& sys, Terms& terms);

}  // namespace taut
