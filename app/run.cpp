#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

#include "base/errors.hpp"
#include "carry_out.hpp"
#include "command_line.hpp"
#include "commands.hpp"
#include "files/set_aside.hpp"
#include "going_on.hpp"
#include "scene_argument.hpp"
#include "systems/scene_source.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

struct RunArguments : SceneArgument {
  std::optional<fs::path> out;
  bool go_on = false, overwrite = false, measure = false;
};

// What a run without a folder could only forget.
void refuse_files_without_folder(const RunSettings& settings) {
  const char* key = settings.trajectory_every > 0                                     ? "trajectory_every"
                    : settings.checkpoint_every > 0                                   ? "checkpoint_every"
                    : settings.checkpoint_minutes != RunSettings{}.checkpoint_minutes ? "checkpoint_minutes"
                                                                                      : nullptr;
  if (key) throw InputError(fmt::format("run.{}: nowhere to write, give --out DIR", key));
}

void refuse_a_run_there(const fs::path& folder) {
  const std::vector<std::string> files = run_files(folder);
  if (files.empty()) return;
  throw InputError(fmt::format(
      "{}: holds a run ({}); --continue goes on with it, --overwrite first moves it aside, to {}.1 "
      "or the next number that is free",
      folder.string(), fmt::join(files, ", "), folder_to_number(folder).string()));
}

void run_to_end(const RunArguments& arguments, Simulation& simulation, RunFolder* folder) {
  std::optional<Measured> measured;
  if (arguments.measure) {
    const RunSettings& run = simulation.scene().run;
    measured.emplace(simulation.scene(), std::vector<std::string>{},
                     static_cast<double>(run.log_every) * run.h());
  }
  carry_out(simulation, folder, measured ? &*measured : nullptr);
}

void run_in_folder(const RunArguments& arguments, Scene scene) {
  const fs::path& folder = *arguments.out;
  const SceneSource source = source_of(scene, !arguments.openmm.empty(), arguments.overrides());
  if (arguments.go_on && fs::exists(checkpoint_file(folder))) {
    FolderLock lock(folder);
    Checkpoint checkpoint = load_checkpoint(folder);
    expect_same_input(folder, checkpoint.source, source);
    go_on(std::move(lock), std::move(checkpoint), {{"run.steps", std::to_string(scene.run.steps)}},
          {.cut_back = true, .begin_anew = false, .how = {}});
    return;
  }
  const bool may_move = arguments.go_on || arguments.overwrite;
  if (!may_move) refuse_a_run_there(folder);
  Simulation simulation(std::move(scene));
  FolderLock lock(folder);
  if (!may_move) refuse_a_run_there(folder);  // another may have been faster
  RunFolder run_folder(std::move(lock), source, simulation);
  run_to_end(arguments, simulation, &run_folder);
}

void run(const RunArguments& arguments) {
  Scene scene = arguments.read();
  if (arguments.out) return run_in_folder(arguments, std::move(scene));
  if (arguments.go_on || arguments.overwrite)
    throw InputError(
        fmt::format("{}: of which folder? give --out DIR", arguments.go_on ? "--continue" : "--overwrite"));
  refuse_files_without_folder(scene.run);
  Simulation simulation(std::move(scene));
  run_to_end(arguments, simulation, nullptr);
}

}  // namespace

void add_run(Commands& commands) {
  auto arguments = std::make_shared<RunArguments>();
  const Subcommand command =
      commands.add("run", "run a scene, or a system prepared for OpenMM", [arguments] { run(*arguments); });
  arguments->offer(command);
  command.option("--out", arguments->out,
                 "folder for log.csv, checkpoint.cbor, summary.json and the final state");
  const Argument go_on = command.flag(
      "--continue", arguments->go_on,
      "go on with the run of the same input in --out, or start it where there is none: for queues");
  command
      .flag("--overwrite", arguments->overwrite, "move what run is in --out to OUT.1, OUT.2, ..., and start")
      .excludes(go_on);
  command
      .flag("--measure", arguments->measure,
            "at the end tell radial distribution, displacement and length of chains, of what is logged")
      .excludes(go_on);
  command.json("print what summary.json holds, in place of the tables");
}

}  // namespace taut
