#pragma once

#include <string>

#include "systems/openmm/input.hpp"

namespace taut {

// Converts a scene to OpenMM's XML, in versions that OpenMM 7.7 and 8.6 and read_openmm() read. Terms without
// a class in OpenMM become custom forces (openmm/formulas.hpp). Throws InputError, one line, for a rigid bond to
// an anchor, which OpenMM cannot express.
std::string openmm_system_xml(const OpenMMInput& from);
std::string openmm_state_xml(const OpenMMInput& from);

// Writes PREFIX.system.xml and PREFIX.state.xml.
void write_openmm(const OpenMMInput& from, const std::string& prefix);

}  // namespace taut
