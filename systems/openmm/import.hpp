#pragma once

#include <filesystem>

#include "systems/openmm/read.hpp"
#include "systems/scene.hpp"

namespace taut {

// Reads files of the XmlSerializer of OpenMM 7.7 to 8.6: a System (masses, virtual sites, constraints,
// forces, the custom forces of openmm/known.hpp) and a State (positions, velocities, time, box, global
// parameters). Molecules that are broken across the box are made whole. Run settings are defaults. Throws
// InputError, one line with file and line, for a missing or truncated file, an unsupported force or setting
// (by name; nothing is skipped), a box not in reduced form, and sizes that do not match.
Scene import_openmm(const std::filesystem::path& system_xml, const std::filesystem::path& state_xml);

// Returns the parts of a scene that OpenMM needs: its system, terms and start.
OpenMMInput openmm_input(const Scene& scene);

}  // namespace taut
