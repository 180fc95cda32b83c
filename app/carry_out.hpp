#pragma once

#include "measured.hpp"
#include "simulation/run_folder.hpp"
#include "simulation/simulation.hpp"

namespace taut {

// Takes the steps that are left of a run, printing and, with a folder, writing as it goes on. `measured`, if
// there is one, sees what is logged and is printed at the end. Throws SimulationFailure with what is known of
// why, and Stopped where it was asked to stop.
void carry_out(Simulation& simulation, RunFolder* folder, Measured* measured = nullptr);

}  // namespace taut
