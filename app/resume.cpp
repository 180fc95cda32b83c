#include <fmt/format.h>

#include <limits>
#include <memory>

#include "base/errors.hpp"
#include "command_line.hpp"
#include "commands.hpp"
#include "going_on.hpp"

namespace taut {
namespace {

struct ResumeArguments {
  std::filesystem::path folder;
  std::optional<long> steps;
  std::vector<std::string> settings;
  bool yes = false;

  KeyValues changes(long taken) const {
    KeyValues changes = key_values(overrides_said({}, settings));
    if (!steps) return changes;
    if (changes.contains("run.steps"))
      throw InputError("--steps and --set run.steps: one of them, the steps to come or all in all");
    if (*steps > std::numeric_limits<long>::max() - taken)
      throw InputError(
          fmt::format("--steps {}: with the {} that are taken more than can be counted", *steps, taken));
    changes["run.steps"] = std::to_string(taken + *steps);
    return changes;
  }
};

void resume(const ResumeArguments& arguments) {
  expect_checkpoint(arguments.folder);
  FolderLock lock(arguments.folder);  // before it is read: who holds it may be writing the next
  Checkpoint checkpoint = load_checkpoint(arguments.folder);
  const KeyValues changes = arguments.changes(checkpoint.step);
  go_on(std::move(lock), std::move(checkpoint), changes,
        {.cut_back = arguments.yes, .begin_anew = arguments.yes, .how = {}});
}

}  // namespace

void add_resume(Commands& commands) {
  auto arguments = std::make_shared<ResumeArguments>();
  const Subcommand command =
      commands.add("resume", "go on with a run that was stopped or killed, or take more steps",
                   [arguments] { resume(*arguments); });
  command.option("folder", arguments->folder, "what the run was given as --out").required();
  command
      .option("--steps", arguments->steps,
              "so many more than were taken (if not said: what is left of the run's)")
      .positive();
  command
      .option("--set", arguments->settings,
              "what may change: run.log_every, run.trajectory_every, run.checkpoint_minutes, thermostat "
              "and barostat")
      .key_values();
  command.flag("--yes", arguments->yes,
               "go on though log or trajectories are cut back to less than half, or are gone and begin anew");
  command.json("print what summary.json holds, in place of the tables");
}

}  // namespace taut
