#pragma once

#include "base/errors.hpp"
#include "simulation/run_folder.hpp"

namespace taut {

// Who looks at a run as it goes on, beside its folder; either may be left out.
struct RunWatch {
  std::function<void(const Record&)> on_record = {};
  std::function<bool(long)> go_on = {};  // after every step: whether to
};

// A failure that was looked back at: the simulation is as it was one step before.
struct ExplainedFailure : SimulationFailure {
  explicit ExplainedFailure(Diagnosis found) : SimulationFailure(found.text()), diagnosis(std::move(found)) {}

  Diagnosis diagnosis;
  std::string unwritten;  // why the folder does not have it; empty: it has
};

// Takes the steps that are left of the scene's. With a folder, rows, frames and checkpoints are written as
// they are due, the last checkpoint where it stops, and at the end summary and final state. Throws
// ExplainedFailure, or a plain SimulationFailure where no step is to blame, and OutsideError.
Summary take_steps(Simulation& simulation, RunFolder* folder, const RunWatch& watch);

}  // namespace taut
