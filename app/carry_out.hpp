#pragma once

#include "measured.hpp"
#include "simulation/run_folder.hpp"
#include "simulation/simulation.hpp"

namespace taut {

// Takes the remaining steps of a run, prints its rows and, with a folder, writes its files. `measured`, if
// not null, receives each logged state and is printed at the end. Throws SimulationFailure with the cause,
// and Stopped after a signal.
void carry_out(Simulation& simulation, RunFolder* folder, Measured* measured = nullptr);

}  // namespace taut
