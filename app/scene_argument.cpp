#include "scene_argument.hpp"

#include <algorithm>
#include <iterator>

#include "base/errors.hpp"
#include "systems/openmm/import.hpp"

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

// True if the System has hydrogens, of up to 4 u, and a rigid bond holds each of them.
static bool holds_hydrogens(const System& sys) {
  std::vector<bool> held(sys.atoms());
  for (const RigidBond& bond : sys.bonds) held[bond.i] = held[bond.j] = true;
  bool any = false;
  for (int atom = 0; atom < sys.atoms(); ++atom) {
    if (sys.mass[atom] == 0 || sys.mass[atom] >= 4) continue;
    if (!held[atom]) return false;
    any = true;
  }
  return any;
}

// Mixed precision differs from double by 1e-6 of the forces and takes two thirds of the time (docs/running.md).
// Where a rigid bond holds each hydrogen, 2 fs keep the energy (benchmarks/README.md).
KeyValues NamedScene::usual_settings(const Scene& imported) const {
  KeyValues usual;
  if (!as_run || openmm.empty()) return usual;
  if (imported.terms.nonbonded || imported.terms.wca) usual["forcefield.precision"] = "mixed";
  if (holds_hydrogens(imported.system)) usual["run.dt_fs"] = "2";
  return usual;
}

Scene NamedScene::read(const std::vector<std::string>& overrides, KeysRead* keys) const {
  if (scene.empty() == openmm.empty()) throw InputError("expected a scene, or --openmm system.xml state.xml");
  if (openmm.empty()) return read_scene(find_scene(scene), overrides, {.keys = keys});
  Scene imported = import_openmm(openmm[0], openmm[1]);
  const KeyValues usual = usual_settings(imported);
  if (usual.contains("forcefield.precision")) imported.terms.precision = Precision::kMixed;
  if (usual.contains("run.dt_fs")) imported.run.dt_fs = 2;
  apply_overrides(imported, overrides, keys);
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

Scene SceneArgument::read(KeysRead* keys, std::vector<std::string> unless) const {
  std::ranges::copy(overrides(), std::back_inserter(unless));
  try {
    return NamedScene::read(unless, keys);
  } catch (const InputError& e) {
    std::string message = e.what();
    for (const KeyFlag& flag : flags()) message = flag.replace_by_flag(message);
    throw InputError(message);
  }
}

}  // namespace taut
