#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "simulation/run_folder.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {

// What a run that finds another run in its folder does.
enum class RunMode {
  kNew,        // refuses
  kOverwrite,  // moves the other run aside and starts
  kContinue,   // continues a run of the same input; starts where there is no checkpoint
  kResume,     // continues the run that is there, whatever its input was
};

// How the program that asks names the options of a run in its own messages.
struct RunOptionNames {
  std::string folder;     // "--out DIR"
  std::string go_on;      // "--continue"
  std::string overwrite;  // "--overwrite"
  std::string resume;     // "`taut resume out`"
  std::string accept;     // "`taut resume out --yes`": accepts that outputs are cut back or start anew
};

// All that a run was told: by `taut run`, `taut resume`, or Python.
struct RunRequest {
  RunMode mode = RunMode::kNew;
  std::filesystem::path folder = {};  // empty: nothing is written
  std::optional<int> threads = {};    // if not given: as before, or the process's default
  bool may_take_all_cores = false;    // a new run for which nobody named a number takes what it gains from
  RunOptionNames names = {};

  // Of a new run. kContinue takes from the scene only how many steps there are.
  std::optional<Scene> scene = {};
  SceneSource source = {};
  KeyValues usual = {};  // keys that the user did not name, which a new run has of the command

  // Of a run that continues.
  std::string checkpoint = {};                         // its bytes, if there is no folder
  KeyValues changes = {};                              // other values for keys of the scene
  std::optional<long> more_steps = {};                 // this many after those taken, in place of run.steps
  std::vector<std::shared_ptr<OwnField>> forces = {};  // its forces that are code
  bool accept = false;                                 // outputs may be cut back or start anew
  std::function<bool(const std::string&)> ask = {};    // asks a person whether outputs may be cut back
  bool leave_finished = false;  // do not open the folder of a run that has taken all of its steps
};

// A simulation that is ready to take steps, and the folder it writes to.
struct OpenRun {
  SceneSource source;
  std::unique_ptr<Simulation> simulation;
  std::optional<RunFolder> folder;  // none: nothing is written
  bool finished = false;            // all steps were taken before, and leave_finished was set
  std::string history = {};         // of a run that continues from a checkpoint: its Checkpoint::history
};

// Opens the folder and makes or restores the simulation. Throws InputError for a folder that holds another run,
// a setting without effect, a setting that cannot change in a run that has begun, a damaged checkpoint, forces
// other than those of the checkpoint, and outputs that may not be cut back. Throws OutsideError for outputs
// that are missing.
OpenRun open_run(RunRequest request);

// Changes settings of a run that has begun, as `taut resume --set` does. Throws InputError for a setting that
// cannot change or would have no effect.
void change_settings(Simulation& simulation, SceneSource& source, const KeyValues& changes);

}  // namespace taut
