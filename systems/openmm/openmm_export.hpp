#pragma once

#include <filesystem>
#include <memory>

#include "systems/openmm/openmm_read.hpp"

namespace OpenMM {
class System;
}

namespace taut {

// The same system as OpenMM's: what taut has and OpenMM has no class for goes into custom forces
// (openmm_expressions.hpp). Throws InputError, one line, for what OpenMM cannot express: a rigid bond to an
// anchor.
std::unique_ptr<OpenMM::System> make_openmm_system(const OpenMMInput& from);

// Writes PREFIX.system.xml and PREFIX.state.xml, which OpenMM reads, and import_openmm reads back.
void write_openmm(const OpenMMInput& from, const std::string& prefix);

}  // namespace taut
