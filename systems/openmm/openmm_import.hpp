#pragma once

#include <filesystem>

#include "systems/scene.hpp"

namespace taut {

bool built_with_openmm();

// Reads what OpenMM's XmlSerializer wrote: a System (masses, constraints, box, forces) and a State
// (positions, velocities, box); of custom forces, those write_openmm writes. Molecules broken across the box
// are made whole. Run settings are defaults. Throws InputError, one line: a file missing or truncated, a
// force or setting taut does not have (by name: nothing is skipped), a triclinic box, virtual sites, sizes
// that do not match.
Scene import_openmm(const std::filesystem::path& system_xml, const std::filesystem::path& state_xml);

}  // namespace taut
