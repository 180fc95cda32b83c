#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "simulation/run_folder.hpp"
#include "systems/toml_reader.hpp"

namespace taut {

// The run as it was at a checkpoint, with other settings where `changes` says so; checkpoint.source then says
// so, too. It goes on with `threads` or, where none are given, as many as asked_threads() says, or else as
// many as before. Throws InputError for a checkpoint that does not fit together (`where` it is), for a
// setting that cannot change in a run that has begun, and where its forces that are code are not the ones
// brought, `own`.
std::unique_ptr<Simulation> resumed(const std::string& where, Checkpoint& checkpoint,
                                    const KeyValues& changes,
                                    const std::vector<std::shared_ptr<OwnField>>& own = {},
                                    std::optional<int> threads = {});

// What may happen to outputs that are not as the checkpoint knows them.
struct Consent {
  bool cut_back = false;                             // to less than half: what is cut off is computed again
  bool begin_anew = false;                           // where one is not there any more, or shorter
  std::string how;                                   // one gives it: "`taut resume out --yes`"
  std::function<bool(const std::string&)> ask = {};  // or somebody is asked whether to cut back
};

// The folder of a run that goes on. Throws InputError or OutsideError where consent is wanting.
RunFolder resumed_folder(FolderLock lock, const Checkpoint& checkpoint, const Simulation& simulation,
                         const Consent& consent);

}  // namespace taut
