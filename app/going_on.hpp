#pragma once

#include "simulation/resumption.hpp"

namespace taut {

// Goes on from a folder's checkpoint, with other settings where `changes` says so, or says that all steps are
// taken. Throws InputError for a setting that cannot change in a run that has begun, and where consent is
// wanting that nobody at a terminal gives.
void go_on(FolderLock lock, Checkpoint checkpoint, const KeyValues& changes, Consent consent);

// Whether a checkpoint is of the same input but for the number of steps and how often there are checkpoints.
// Throws InputError that says what differs.
void expect_same_input(const std::filesystem::path& folder, const SceneSource& kept,
                       const SceneSource& given);

}  // namespace taut
