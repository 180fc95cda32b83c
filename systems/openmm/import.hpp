#pragma once

#include <filesystem>

#include "systems/openmm/read.hpp"
#include "systems/scene.hpp"

namespace taut {

// Reads what the XmlSerializer of OpenMM 7.7 to 8.6 writes: a System (masses, virtual sites, constraints,
// forces) and a State (positions, velocities, time, box, global parameters); of custom forces, those of
// openmm/known.hpp. Molecules broken across the box are made whole. Run settings are defaults. Throws
// InputError, one line with file and line: a file missing or truncated, a force or setting taut does not have
// (by name: nothing is skipped), a box not in reduced form, sizes that do not match.
Scene import_openmm(const std::filesystem::path& system_xml, const std::filesystem::path& state_xml);

// What OpenMM is to be given of a scene: its system, terms and start.
OpenMMInput openmm_input(const Scene& scene);

}  // namespace taut
