#pragma once

#include "constraints/registry.hpp"
#include "openmm_plugin/held_dynamics.hpp"

namespace taut {

// The method with the options that the settings give. Throws InputError for an unknown method or option, and for a
// value out of range.
MethodOptions method_of(const HoldSettings& settings);

// The masses and bonds as taut's System. Bonds between two atoms without mass are left out: they never move.
System system_of(const HeldBonds& held);

}  // namespace taut
