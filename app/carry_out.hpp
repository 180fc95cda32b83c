#pragma once

#include "measured.hpp"
#include "simulation/run_folder.hpp"
#include "simulation/simulation.hpp"

namespace taut {

// What is told of a run.
struct Telling {
  bool json = false;             // the summary alone, as summary.json has it
  Measured* measured = nullptr;  // sees what is logged, and is told at the end
};

// Takes the steps that are left of a run, printing and, with a folder, writing as it goes on. Throws
// SimulationFailure with what is known of why, and Stopped where it was asked to stop.
void carry_out(Simulation& simulation, RunFolder* folder, const Telling& telling);

}  // namespace taut
