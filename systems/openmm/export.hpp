#pragma once

#include <string>

#include "systems/openmm/read.hpp"

namespace taut {

// The same system and start as OpenMM's XML, in versions that 7.7 and 8.6 both read, and read_openmm reads
// back. What taut has and OpenMM has no class for goes into custom forces (openmm/known.hpp). Throws
// InputError, one line, for what OpenMM cannot express: a rigid bond to an anchor.
std::string openmm_system_xml(const OpenMMInput& from);
std::string openmm_state_xml(const OpenMMInput& from);

// Writes them as PREFIX.system.xml and PREFIX.state.xml.
void write_openmm(const OpenMMInput& from, const std::string& prefix);

}  // namespace taut
