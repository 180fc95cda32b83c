#pragma once

#include "simulation/resumption.hpp"

namespace taut {

// Continues from a folder's checkpoint with the settings in `changes`, or reports that all steps are done.
// Throws InputError for a setting that cannot change during a run, and if it needs a confirmation and there
// is no terminal to ask.
void go_on(FolderLock lock, Checkpoint checkpoint, const KeyValues& changes, Consent consent);

// Returns whether a checkpoint has the same input, apart from the number of steps and the interval of
// checkpoints. Throws InputError that names the difference.
void expect_same_input(const std::filesystem::path& folder, const SceneSource& kept,
                       const SceneSource& given);

}  // namespace taut
