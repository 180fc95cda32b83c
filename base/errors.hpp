#pragma once

#include <stdexcept>

namespace taut {

// Each kind of failure has the exit code of the command that meets it.

// 1: the simulation failed (no convergence, a bond broke, numbers ran away).
struct SimulationFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// 1 as well: code of the user's own threw, or returned what is no number.
struct OwnCodeFailure : SimulationFailure {
  using SimulationFailure::SimulationFailure;
};

// 2: the input is wrong. The message is one line: file, line, key, what was expected.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// 3: something outside (a folder that cannot be written, a full disk).
struct OutsideError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace taut
