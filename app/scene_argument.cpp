#include "scene_argument.hpp"

#include <algorithm>
#include <iterator>

#include "base/errors.hpp"
#include "systems/openmm/import.hpp"
#include "systems/openmm/xml.hpp"

namespace taut {

void NamedScene::offer(const Subcommand& command) {
  command.option("scene", scene, "a scene's file, or its name as `taut scenes` lists it").words(0, "SCENE");
  command.option("--openmm", openmm, "OpenMM System and State, as XML").words(2, "SYSTEM.XML STATE.XML");
}

CommandLine NamedScene::line(const char* subcommand) const {
  CommandLine line(subcommand, scene);
  line.option("--openmm", openmm);
  return line;
}

Scene NamedScene::read(const std::vector<std::string>& overrides, KeysRead* keys, RunRequest* run) const {
  if (scene.empty() == openmm.empty()) throw InputError("expected a scene, or --openmm system.xml state.xml");
  if (openmm.empty()) return read_scene(find_scene(scene), overrides, {.keys = keys});
  const XmlFile system(openmm[0], "System"), state(openmm[1], "State");
  Scene imported = import_openmm(system, state);
  const KeyValues usual = as_run ? take_usual_settings(imported) : KeyValues();
  apply_overrides(imported, overrides, keys);
  if (run) {
    run->source = source_of(system, state, overrides);
    run->usual = usual;
  }
  return imported;
}

void SceneArgument::offer(const Subcommand& command) {
  NamedScene::offer(command);
  command
      .option("--method", method,
              "constraint method (see `taut methods`), with settings as in rattle:sweeps=4")
      .words(0, "METHOD");
  command.option("--steps", steps, "number of steps");
  command.option("--precision", precision, "of pair forces and PME: double or mixed").words(0, "WORD");
  offer_settings(command);
}

void SceneArgument::offer_settings(const Subcommand& command) {
  command.option("--dt-fs", dt_fs, "step length [fs]");
  command
      .option("--set", settings,
              "any key of the scene: run.seed=7, method.tolerance=1e-12 (see `taut help KEY`)")
      .key_values();
}

std::vector<KeyFlag> SceneArgument::flags() const {
  std::vector<KeyFlag> flags = {{"--steps", "run.steps", steps},
                                {"--precision", "forcefield.precision", precision},
                                {"--dt-fs", "run.dt_fs", dt_fs}};
  if (method)
    for (const std::string& override_ : overrides_of_method(*method))
      flags.emplace_back("--method " + *method, override_);
  return flags;
}

std::vector<std::string> SceneArgument::overrides() const {
  return collect_overrides(flags(), settings);
}

Scene SceneArgument::read(KeysRead* keys, std::vector<std::string> unless, RunRequest* run) const {
  std::ranges::copy(overrides(), std::back_inserter(unless));
  try {
    return NamedScene::read(unless, keys, run);
  } catch (const InputError& e) {
    std::string message = e.what();
    for (const KeyFlag& flag : flags()) message = flag.replace_by_flag(message);
    throw InputError(message);
  }
}

}  // namespace taut
