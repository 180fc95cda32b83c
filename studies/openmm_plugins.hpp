#pragma once

// OpenMM's platforms beside Reference, and taut's integrator in OpenMM, are plug-ins that are loaded when asked for.

#include <string>

namespace OpenMM {
class Platform;
}

namespace taut {

// Throws InputError for a platform that this OpenMM does not have.
OpenMM::Platform& platform_by_name(const std::string& name);

// Loads libtaut_openmm.so with its part for the platform: the file that TAUT_OPENMM_PLUGIN names, or that of this
// OpenMM's version beside taut. Throws InputError, with what to do, where there is none.
void load_taut_plugin(const std::string& platform);

}  // namespace taut
