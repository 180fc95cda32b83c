#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "systems/openmm/input.hpp"
#include "systems/scene/scene.hpp"

namespace taut {

// Reads what the XmlSerializer of OpenMM 7.7 to 8.6 writes: a System (masses, virtual sites, constraints,
// forces) and a State (positions, velocities, time, box, global parameters). Custom forces are read if their
// energy is one of those in openmm/custom_*.cpp. Molecules broken across the box are made whole. Run settings
// are defaults. Throws InputError, one line with file and line, for a missing or truncated file, a force or
// setting that taut does not have (nothing is skipped), a box not in reduced form, and sizes that differ.
Scene import_openmm(const std::filesystem::path& system_xml, const std::filesystem::path& state_xml);
Scene import_openmm(const XmlFile& system, const XmlFile& state);

// What a run takes of a precision and a step where nobody says them, as the files do not: sets it in a scene as it was
// imported, and returns it as settings. Studies and Python take those of scenes, which compare best.
std::map<std::string, std::string> take_usual_settings(Scene& imported);

// Returns the parts of a scene that OpenMM gets: its system, terms and start.
OpenMMInput openmm_input(const Scene& scene);

}  // namespace taut
