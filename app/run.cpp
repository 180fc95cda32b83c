#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "carry_out.hpp"
#include "commands.hpp"
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

  // --method, --steps and --dt-fs are short for keys; --set comes last and so prevails.
  std::vector<std::string> overrides() const {
    std::vector<std::string> all;
    if (method) all.push_back(fmt::format("method.name=\"{}\"", *method));
    if (steps) all.push_back(fmt::format("run.steps={}", *steps));
    if (dt_fs) all.push_back(fmt::format("run.dt_fs={}", *dt_fs));
    all.insert(all.end(), settings.begin(), settings.end());
    return all;
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
  const char* key = settings.trajectory_every > 0   ? "trajectory_every"
                    : settings.checkpoint_every > 0 ? "checkpoint_every"
                                                    : nullptr;
  if (key) throw InputError(fmt::format("run.{}: nowhere to write, give --out DIR", key));
}

void run(const RunArguments& arguments) {
  Simulation simulation(arguments.read());
  if (!arguments.out) refuse_files_without_folder(simulation.scene().run);
  std::optional<RunFolder> folder;
  if (arguments.out)
    folder.emplace(FolderLock(*arguments.out),
                   source_of(simulation.scene(), !arguments.openmm.empty(), arguments.overrides()),
                   simulation);
  carry_out(simulation, folder ? &*folder : nullptr);
}

}  // namespace

void add_run(CLI::App& app, std::vector<std::pair<CLI::App*, Action>>& actions) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "run a scene, or a system prepared for OpenMM");
  command->add_option("scene", arguments->scene, "a scene's file, or its name as `taut scenes` lists it");
  command->add_option("--openmm", arguments->openmm, "OpenMM System and State, as XML")
      ->expected(2)
      ->type_name("SYSTEM.XML STATE.XML");
  command->add_option("--method", arguments->method, "constraint method (see `taut methods`)");
  command->add_option("--steps", arguments->steps, "number of steps");
  command->add_option("--dt-fs", arguments->dt_fs, "step length [fs]");
  command
      ->add_option("--set", arguments->settings, "any key of the scene: run.seed=7, method.tolerance=1e-12")
      ->type_name("KEY=VALUE");
  command->add_option("--out", arguments->out,
                      "folder for log.csv, checkpoint.cbor, summary.json and the final state");
  actions.emplace_back(command, [arguments] { run(*arguments); });
}

}  // namespace taut
