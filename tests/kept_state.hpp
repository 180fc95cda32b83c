#pragma once

#include <string>

#include "simulation/simulation.hpp"

namespace taut {

// All that a checkpoint keeps of a simulation, as bytes.
inline std::string kept(Simulation& simulation) {
  std::string bytes;
  Archive archive = Archive::saving_to(bytes);
  simulation.serialize(archive);
  return bytes;
}

}  // namespace taut
