#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "forcefield/terms.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

struct OpenMMBarostat {  // a MonteCarloBarostat
  double pressure_bar;
  long every;  // steps
};

// The contents of OpenMM's two files.
struct OpenMMInput {
  System system;
  Terms terms;
  State start;                     // whole molecules, anchors at rest; a box if any force is periodic
  long remove_momentum_every = 0;  // steps; 0: never
  bool has_velocities = true;      // whether the State has them; if not, all atoms are at rest
  std::optional<OpenMMBarostat> barostat{};
  std::vector<std::string> notes{};  // messages about parts of the State that are not used
};

// Reads both files; import_openmm() calls it. OpenMM itself is not needed.
OpenMMInput read_openmm(const std::filesystem::path& system_xml, const std::filesystem::path& state_xml);

}  // namespace taut
