#pragma once

#include "files/folder_lock.hpp"
#include "simulation/checkpoint.hpp"
#include "systems/toml_reader.hpp"

namespace taut {

// What may happen to outputs that are not as the checkpoint knows them.
struct Consent {
  bool cut_back = false;    // to less than half: what is cut off is computed again
  bool begin_anew = false;  // where one is not there any more, or shorter
};

// Goes on from a folder's checkpoint, with other settings where `changes` says so, or says that all steps are
// taken. Throws InputError for a setting that cannot change in a run that has begun, and where consent is
// wanting that nobody at a terminal gives.
void go_on(FolderLock lock, Checkpoint checkpoint, const KeyValues& changes, Consent consent);

// Whether a checkpoint is of the same input but for the number of steps and how often there are checkpoints.
// Throws InputError that says what differs.
void expect_same_input(const std::filesystem::path& folder, const SceneSource& kept,
                       const SceneSource& given);

}  // namespace taut
