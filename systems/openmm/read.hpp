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

// What OpenMM's two files hold.
struct OpenMMInput {
  System system;
  Terms terms;
  State start;                     // molecules whole, anchors at rest; a box where any force is periodic
  long remove_momentum_every = 0;  // steps; 0: never
  bool has_velocities = true;      // in the State; if not, all is at rest
  std::optional<OpenMMBarostat> barostat{};
  std::vector<std::string> notes{};  // what of the State is not used, a line each
};

// The reading behind import_openmm, and its refusals. Needs no OpenMM.
OpenMMInput read_openmm(const std::filesystem::path& system_xml, const std::filesystem::path& state_xml);

}  // namespace taut
