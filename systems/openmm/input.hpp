#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "forcefield/terms.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

class XmlFile;

struct OpenMMBarostat {  // a MonteCarloBarostat
  double pressure_bar;
  long every;  // steps
};

// The contents of OpenMM's two files.
struct OpenMMInput {
  System system;
  Terms terms;
  State start;  // molecules are whole and anchors at rest; a box only if a force is periodic
  long remove_momentum_every = 0;  // steps; 0: never
  bool has_velocities = true;      // false: the State has none, and all atoms are at rest
  std::optional<OpenMMBarostat> barostat{};
  std::vector<std::string> notes{};  // parts of the State that are not used, a line each
};

// Reads the files for import_openmm(). Needs no OpenMM.
OpenMMInput read_openmm(const std::filesystem::path& system_xml, const std::filesystem::path& state_xml);
OpenMMInput read_openmm(const XmlFile& system, const XmlFile& state);

}  // namespace taut
