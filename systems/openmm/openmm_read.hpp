#pragma once

#include <filesystem>

#include "forcefield/terms.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// What OpenMM's two files hold, none of it OpenMM's any more.
struct OpenMMInput {
  System system;  // its box is the State's, where any force is periodic
  Terms terms;
  State start;                     // molecules whole, anchors at rest
  long remove_momentum_every = 0;  // steps; 0: never
};

// The reading behind import_openmm, and its refusals.
OpenMMInput read_openmm(const std::filesystem::path& system_xml, const std::filesystem::path& state_xml);

}  // namespace taut
