#pragma once

#include "simulation/run_folder.hpp"
#include "simulation/simulation.hpp"

namespace taut {

// Takes the steps that are left of a run, printing (`json`: the summary alone, as summary.json has it) and,
// with a folder, writing as it goes on. Throws
// SimulationFailure with what is known of why, and Stopped where it was asked to stop.
void carry_out(Simulation& simulation, RunFolder* folder, bool json);

}  // namespace taut
