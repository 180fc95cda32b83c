#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

#include "carry_out.hpp"
#include "command_line.hpp"
#include "commands.hpp"
#include "going_on.hpp"
#include "md/errors.hpp"
#include "systems/openmm/openmm_import.hpp"
#include "systems/scene_file.hpp"
#include "systems/scene_source.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

struct RunArguments {
  std::string scene;
  std::vector<std::string> openmm;  // system.xml, state.xml
  std::optional<std::string> method;
  std::optional<long> steps;
  std::optional<double> dt_fs;
  std::vector<std::string> settings;
  std::optional<fs::path> out;
  bool go_on = false, overwrite = false;

  std::vector<std::string> overrides() const {
    return overrides_said({{"--method", "method.name", method},
                           {"--steps", "run.steps", steps},
                           {"--dt-fs", "run.dt_fs", dt_fs}},
                          settings);
  }

  Scene read() const {
    if (scene.empty() == openmm.empty())
      throw InputError("taut run: expected a scene, or --openmm system.xml state.xml");
    if (openmm.empty()) return read_scene(find_scene(scene), overrides());
    Scene imported = import_openmm(openmm[0], openmm[1]);
    apply_overrides(imported, overrides());
    return imported;
  }
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
      folder.string(), fmt::join(files, ", "), folder.string()));
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
  carry_out(simulation, &run_folder);
}

void run(const RunArguments& arguments) {
  Scene scene = arguments.read();
  if (arguments.out) return run_in_folder(arguments, std::move(scene));
  if (arguments.go_on || arguments.overwrite)
    throw InputError(
        fmt::format("{}: of which folder? give --out DIR", arguments.go_on ? "--continue" : "--overwrite"));
  refuse_files_without_folder(scene.run);
  Simulation simulation(std::move(scene));
  carry_out(simulation, nullptr);
}

}  // namespace

void add_run(Commands& commands) {
  auto arguments = std::make_shared<RunArguments>();
  const Subcommand command =
      commands.add("run", "run a scene, or a system prepared for OpenMM", [arguments] { run(*arguments); });
  command.option("scene", arguments->scene, "a scene's file, or its name as `taut scenes` lists it");
  command.option("--openmm", arguments->openmm, "OpenMM System and State, as XML")
      .words(2, "SYSTEM.XML STATE.XML");
  command.option("--method", arguments->method, "constraint method (see `taut methods`)");
  command.option("--steps", arguments->steps, "number of steps");
  command.option("--dt-fs", arguments->dt_fs, "step length [fs]");
  command.option("--set", arguments->settings, "any key of the scene: run.seed=7, method.tolerance=1e-12")
      .key_values();
  command.option("--out", arguments->out,
                 "folder for log.csv, checkpoint.cbor, summary.json and the final state");
  const Argument go_on = command.flag(
      "--continue", arguments->go_on,
      "go on with the run of the same input in --out, or start it where there is none: for queues");
  command
      .flag("--overwrite", arguments->overwrite, "move what run is in --out to OUT.1, OUT.2, ..., and start")
      .excludes(go_on);
}

}  // namespace taut
