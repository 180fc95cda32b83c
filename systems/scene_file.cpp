#include "systems/scene_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/errors.hpp"
#include "base/nearest_name.hpp"
#include "files/h5md_file.hpp"
#include "forcefield/bonded/tabulated.hpp"
#include "forcefield/force_field.hpp"
#include "systems/builders/biases.hpp"
#include "systems/builders/builders.hpp"
#include "systems/net_pull.hpp"
#include "systems/openmm/force_overrides.hpp"
#include "systems/start_file.hpp"
#include "systems/toml_reader.hpp"
#include "systems/velocities.hpp"

namespace taut {
namespace {

constexpr Range kCounts{.min = 1};

void read_barostat(const TomlTable& table, RunSettings& run) {
  table.read("barostat", run.barostat,
             {"what keeps the pressure: stochastic cell rescaling, or whole molecules by Monte Carlo",
              {"none", "c-rescale", "monte-carlo"}});
  table.read("pressure_bar", run.pressure_bar, {"pressure the barostat keeps", "bar"});
  table.read("barostat_every", run.barostat_every,
             {"from one change of the box to the next", "steps", kCounts});
  table.read("barostat_ps", run.barostat_ps, {"relaxation time of the box", "ps", kPositive});
  table.read("compressibility_per_bar", run.compressibility_per_bar,
             {"a guess of the compressibility, which sets the pace alone; water's", "1/bar", kPositive});
  table.read(
      "coupling", run.coupling,
      {"which edges change alike: all, x and y, none", {"isotropic", "semi-isotropic", "anisotropic"}});

  for (const char* key : {"pressure_bar", "barostat_every"})
    table.require_effect(key, run.barostat != "none", "with run.barostat = \"c-rescale\" or \"monte-carlo\"");
  for (const char* key : {"barostat_ps", "compressibility_per_bar", "coupling"})
    table.require_effect(key, run.barostat == "c-rescale", "with run.barostat = \"c-rescale\"");
}

// Checks that the scene has what a barostat needs.
void check_barostat(const TomlTable& run, const Scene& scene) {
  if (scene.run.barostat == "none") return;
  if (!scene.run.thermostatted())
    run.fail("barostat", "a barostat needs a thermostat: run.thermostat = \"langevin\" or \"rescaling\"");
  if (!scene.start.box.periodic()) run.fail("barostat", "there is no box to change; leave the key out");
  const auto& pairs = scene.terms.nonbonded;
  if (pairs && !pairs->cutoff)
    run.fail("barostat",
             "pairs without a cutoff act across no box, so that it cannot keep their pressure; give them a "
             "cutoff, or leave the key out");
  if (!pairs && !scene.terms.wca && !scene.terms.tabulated_pairs && scene.run.coupling != "isotropic")
    run.fail("coupling",
             "no pairs of atoms act across the box, so nothing holds its shape: take \"isotropic\"");
  if (!scene.closed_but_for_restraints())
    run.fail(
        "barostat",
        "an anchored atom (mass 0), gravity, a pull, a wall or a steered atom holds on to what the box would "
        "move; leave the key out");
  if (!scene.closed() && scene.run.barostat != "monte-carlo")
    run.fail("barostat",
             "restraints hold on to what the box would move, and have no virial: take \"monte-carlo\"");
}

// Refuses settings that do not support struts and ropes.
void check_one_sided(const TomlTable& run, const TomlTable& method, const Scene& scene) {
  if (scene.run.minimise)
    run.fail("minimise", "moves atoms through one-sided bonds (at_least, at_most): leave it out");
  try {
    scene.method.refuse_one_sided(scene.system);
  } catch (const InputError& e) {
    method.fail("name", e.what());
  }
}

void read_temperature(const TomlTable& table, RunSettings& run) {
  Course course = run.temperature_course;
  if (course.empty()) course = Course({{0, run.temperature_k}});
  table.read(
      "temperature_k", course,
      {"of velocities that are drawn, and of the thermostat; rows [ps, K]: the thermostat's, along straight "
       "lines; 0: none",
       "K", kNotNegative});
  run.temperature_k = course.at(0);
  run.temperature_course = course.points().size() > 1 ? std::move(course) : Course();
}

// After the pulls are known.
void settle_pulls(const TomlTable& run, Scene& scene) {
  run.require_effect("pull_factor", !scene.terms.pulls.empty(), "with pulls");
  scene.terms.pull_factor = scene.run.pull_factor;
}

// After all that holds molecules is known. Overrides of a scene that has the note already repeat it.
void note_net_pull(Scene& scene) {
  const std::string message = net_pull_message(scene);
  if (!message.empty() && std::ranges::find(scene.notes, message) == scene.notes.end())
    scene.notes.push_back(message);
}

// After the thermostat is known.
void check_courses(const TomlTable& table, const RunSettings& run) {
  if (run.temperature_course.empty()) return;
  for (std::size_t k = 0; k < run.temperature_course.points().size(); ++k)
    if (run.temperature_course.points()[k].value == 0)
      table.fail("temperature_k", k, "expected a temperature above 0");
  if (!run.thermostatted())
    table.fail("temperature_k",
               "no thermostat follows rows of time and temperature; give run.thermostat, or one temperature");
  if (run.metric_correction)
    table.fail("metric_correction", "takes one run.temperature_k, not rows of time and temperature");
}

void read_run(const TomlTable& table, RunSettings& run) {
  table.read("dt_fs", run.dt_fs, {"length of a step", "fs", kPositive});
  table.read("steps", run.steps, {"how many steps", "", kNotNegative});
  read_temperature(table, run);
  table.read("pull_factor", run.pull_factor,
             {"rows [ps, number] by which all pulls are multiplied, along straight lines; if not said, 1"});
  table.read("seed", run.seed, {"of all that is drawn", "", kNotNegative});
  table.read("log_every", run.log_every, {"from row to row of the log", "steps", kCounts});
  table.read("remove_momentum_every", run.remove_momentum_every,
             {"from one removal of the whole's momentum to the next; 0: never", "steps", kNotNegative});
  table.read("trajectory_every", run.trajectory_every,
             {"from frame to frame; 0: no trajectory", "steps", kNotNegative});
  table.read("trajectory", run.trajectory, {"its format", {"dcd", "h5md", "both"}});
  table.read(
      "checkpoint_every", run.checkpoint_every,
      {"a checkpoint every so many, besides those by the clock; 0: none besides", "steps", kNotNegative});
  table.read("checkpoint_minutes", run.checkpoint_minutes,
             {"of computing from checkpoint to checkpoint; 0: not by the clock", "min", kNotNegative});
  table.read("redundant", run.redundant, {"bonds that follow from others", {"refuse", "drop"}});
  table.read("thermostat", run.thermostat,
             {"what keeps the temperature; if not said, rescaling where thermostat_ps is above 0",
              {"none", "langevin", "rescaling"}});
  table.read("thermostat_ps", run.thermostat_ps,
             {"relaxation time of velocity rescaling; 0: none", "ps", kNotNegative});
  table.read("friction_per_ps", run.friction_per_ps,
             {"friction of Langevin's thermostat", "1/ps", kNotNegative});
  table.read("minimise", run.minimise, {"relax the start first"});
  table.read("soft_start", run.soft_start,
             {"before that push overlapping atoms apart by soft forces, A(1 + cos(πr/r_c)) between pairs"});
  table.require_effect("soft_start", run.minimise, "with run.minimise = true");
  table.read("minimise_force_kj_mol_nm", run.minimise_force,
             {"until no atom's force is above this", "kJ/mol/nm", kPositive});
  table.read(
      "metric_correction", run.metric_correction,
      {"Fixman's potential ½kT ln det A at run.temperature_k: rigid bonds with the statistics of flexible "
       "chains"});
  if (run.metric_correction && run.temperature_k == 0)
    table.fail("metric_correction", "needs a run.temperature_k above 0, as 300");
  table.read("velocities", run.velocities,
             {"those of the start, or drawn; if not said, drawn where it has none", {"keep", "draw"}});

  table.require_effect("minimise_force_kj_mol_nm", run.minimise, "with run.minimise = true");
  table.require_effect("trajectory", run.trajectory_every > 0, "with run.trajectory_every above 0");
  if (run.trajectory_every > 0 && run.trajectory != "dcd" && !built_with_hdf5())
    table.fail("trajectory", "taut was built without HDF5 (libhdf5-dev): \"dcd\" needs none");
  table.require_effect("friction_per_ps", run.langevin(), "with run.thermostat = \"langevin\"");
  table.require_effect("thermostat_ps", run.rescaling() || run.thermostat_ps == 0,
                       "with run.thermostat = \"rescaling\"");
  const char* key = table.has("thermostat") ? "thermostat" : "thermostat_ps";
  if (run.thermostatted() && run.temperature_k == 0)
    table.fail(key, "a thermostat needs a run.temperature_k above 0");
  check_courses(table, run);
  if (run.rescaling() && run.thermostat_ps == 0)
    table.fail("thermostat", "rescaling needs its relaxation time, run.thermostat_ps above 0");
  read_barostat(table, run);
  table.reject_unknown();
}

// Another method starts from its own defaults (scene_file.hpp).
void read_name(const TomlTable& table, MethodOptions& method) {
  std::string name(method.name());
  table.read("name", name, {"who holds the bonds (see `taut methods`)", method_names()});
  if (name == method.name()) return;
  table.forget_others("name");
  method = default_options(name);
}

void read_options(const TomlTable& table, MethodOptions& method) {
  for (const Option& option : method.describe()) {
    About about(option.meaning, option.about.unit, option.about.range);
    about.words.assign(option.about.words.begin(), option.about.words.end());
    std::visit([&](auto* field) { table.read(option.key, *field, about); }, option.field);
  }
  for (const Option& option : method.describe())
    table.require_effect(option.key, option.about.counts.read, option.about.counts.where);
}

// Reads the run settings of a scene whose atoms are placed. Keys of the file that belong to a start or
// velocities that overrides have replaced are ignored; other keys without effect are refused.
void settle_velocities(const TomlTable& run, bool set_aside, Scene& scene) {
  const RunSettings& settings = scene.run;
  if (settings.velocities == "draw" && settings.temperature_k == 0)
    run.fail("velocities", "drawn at run.temperature_k, which is 0; give one, or run.velocities = \"keep\"");
  give_velocities(scene);
  const bool draws = scene.velocities_drawn || settings.thermostatted();
  if (run.overridden("temperature_k") || !set_aside)
    run.require_effect(
        "temperature_k", draws || settings.metric_correction || settings.temperature_k == 0,
        "with a thermostat or run.velocities = \"draw\": the start has velocities, which are kept");
  if (run.overridden("seed"))
    run.require_effect("seed", draws || scene.positions_drawn,
                       "where something is drawn: here positions and velocities are the start's");
}

void read_words(const TomlTable& root, Scene& scene) {
  root.read("hard_on", scene.hard_on, {"what the scene is hard on, in a sentence"});
}

void read_settings(const TomlTable& root, Scene& scene) {
  read_run(root.section("run"), scene.run);
  const TomlTable method = root.section("method");
  read_name(method, scene.method);
  read_options(method, scene.method);
  method.reject_unknown();
}

// The keys that name further files: build.start, the coordinates and tables of molecules, and those of places and
// pairs.
std::vector<toml::value<std::string>*> file_names(toml::table& root) {
  std::vector<toml::value<std::string>*> names;
  const auto add = [&](toml::node_view<toml::node> section, std::string_view key) {
    if (auto* name = section[key].as_string()) names.push_back(name);
  };
  add(root["build"], "start");
  add(root["build"], "data");
  if (auto* molecules = root["molecule"].as_table())
    for (auto&& [name, molecule] : *molecules) {
      const toml::node_view<toml::node> keys(molecule);
      add(keys, "file");
      if (auto* tables = keys["tables"].as_array())
        for (toml::node& table : *tables) add(toml::node_view<toml::node>(table), "file");
    }
  if (auto* places = root["place"].as_array())
    for (toml::node& place : *places) add(toml::node_view<toml::node>(place), "file");
  if (auto* pairs = root["pair"].as_array())
    for (toml::node& pair : *pairs) add(toml::node_view<toml::node>(pair), "table");
  return names;
}

// Changes their paths, but keeps whether the file or an override names them.
void move_files(toml::table& root, const std::vector<std::filesystem::path>& moved) {
  if (moved.empty()) return;
  const auto names = file_names(root);
  if (names.size() != moved.size()) throw InputError("the files of the scene are not all there");
  for (std::size_t k = 0; k < names.size(); ++k) *names[k] = moved[k].string();
}

// An override may only change an existing molecule or atom; another name is a misspelling.
void refuse_new_names(const toml::table& base, const toml::table& overrides) {
  for (const char* section : {"atom", "molecule"}) {
    const toml::table *there = base[section].as_table(), *changed = overrides[section].as_table();
    if (!changed) continue;
    std::vector<std::string_view> names;
    if (there)
      for (const auto& entry : *there) names.push_back(entry.first.str());
    for (const auto& [name, node] : *changed)
      if (std::ranges::find(names, name.str()) == names.end())
        throw LocatedError(fmt::format("{}: there is no [{}.{}]{}", *node.source().path, section, name.str(),
                                       did_you_mean(name.str(), names)));
  }
}

void refuse_start_below_tables(const Scene& scene, ForceField& forces) {
  State s = scene.start;
  try {
    forces.evaluate(scene.system, s);
  } catch (const SimulationFailure& e) {
    throw InputError(fmt::format(
        "at the start {}; run.minimise = true with run.soft_start = true pushes atoms apart first",
        e.what()));
  }
}

Scene read_parsed(const std::filesystem::path& file, toml::table base, toml::table overrides,
                  const SceneReading& how) {
  if (base.contains("atoms") && !base.contains("build"))
    throw InputError("a start, not a scene; a scene goes on from it: --set build.start=" + file.string());
  Scene scene;
  scene.name = file.stem().string();
  scene.files = {file};
  scene.method = default_options(kUsualMethod);
  read_settings(TomlTable(base, file.string(), how.keys), scene);
  const RunSettings of_file = scene.run;
  const bool another_start = bool(overrides["build"]["start"]);
  if (another_start) scene.run.velocities.clear();
  read_settings(TomlTable(overrides, "--set", how.keys), scene);

  refuse_new_names(base, overrides);
  overwrite(base, std::move(overrides));
  move_files(base, how.files);
  const TomlTable root(base, file.string(), how.keys);
  read_words(root, scene);
  for (const char* known : {"run", "method", "atom", "molecule", "place", "pair", "wall", "bias"})
    root.has(known);
  const TomlTable build_keys = root.section("build"), forcefield_keys = root.section("forcefield");
  const TomlTable run_keys = root.section("run");
  root.reject_unknown();
  build({root, build_keys, forcefield_keys, scene.run}, scene);
  read_biases(root, scene);
  for (const auto* name : file_names(base)) scene.files.push_back(path_of(*name));
  settle_pulls(run_keys, scene);
  settle_velocities(run_keys,
                    another_start || run_keys.overridden("velocities") || of_file.thermostatted() ||
                        of_file.velocities == "draw",
                    scene);
  check_barostat(run_keys, scene);
  note_net_pull(scene);
  if (!scene.system.one_sided.empty()) check_one_sided(run_keys, root.section("method"), scene);
  build_keys.reject_unknown();
  forcefield_keys.reject_unknown();
  check_tables_cover(scene.terms, scene.start.x);
  // Refuses settings that contradict each other while the file's name is known.
  ForceField fitting(scene.system, scene.start.box, scene.terms);
  if (scene.terms.tabulated_pairs && !scene.run.minimise) refuse_start_below_tables(scene, fitting);
  return scene;
}

// In the order of a scene's sections.
int order_of(const Key& key) {
  return static_cast<int>(std::ranges::find(kSections, key.section) - kSections.begin());
}

// Merges the keys of one kind, or of one method, into those of all.
void merge(std::vector<Key>& all, KeysRead&& described, std::string_view kind) {
  for (Key& key : described.all) {
    if (!key.read) continue;
    const auto alike = [&](const Key& other) { return other.described_as(key); };
    auto known = std::ranges::find_if(all, alike);
    if (known == all.end()) known = all.insert(all.end(), std::move(key));
    if (!kind.empty()) known->kinds.emplace_back(kind);
  }
}

}  // namespace

std::vector<Key> every_key() {
  const toml::table empty;
  std::vector<Key> all;
  const auto describe = [&](std::string_view kind, const auto& read) {
    KeysRead described{.describing = true};
    Scene scene;
    read(TomlTable(empty, "", &described), scene);
    merge(all, std::move(described), kind);
  };
  describe("", [](const TomlTable& root, Scene& scene) {
    read_words(root, scene);
    read_biases(root, scene);
    read_run(root.section("run"), scene.run);
    scene.method = default_options(kUsualMethod);
    read_name(root.section("method"), scene.method);
  });
  for (const std::string_view kind : kinds())
    describe(kind, [&](const TomlTable& root, Scene& scene) {
      build({root, root.section("build"), root.section("forcefield"), scene.run}, scene, kind);
    });
  for (const std::string_view name : method_names())
    describe(name, [&](const TomlTable& root, Scene& scene) {
      scene.method = default_options(name);
      read_options(root.section("method"), scene.method);
    });
  describe("", [](const TomlTable& root, Scene&) { read_start(root.section("start")); });
  std::ranges::stable_sort(all, [](const Key& a, const Key& b) { return order_of(a) < order_of(b); });
  return all;
}

Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                 const SceneReading& how) {
  return read_scene(parse_toml_file(file), file, overrides, how);
}

Scene read_scene(toml::table&& table, const std::filesystem::path& file,
                 const std::vector<std::string>& overrides, const SceneReading& how) {
  try {
    return read_parsed(file, std::move(table), parse_overrides(overrides), how);
  } catch (const LocatedError&) {
    throw;
  } catch (const InputError& e) {
    throw LocatedError(file.string() + ": " + e.what());
  }
}

void apply_overrides(Scene& scene, const std::vector<std::string>& overrides, KeysRead* keys) {
  const toml::table table = parse_overrides(overrides);
  const TomlTable root(table, "--set", keys);
  read_settings(root, scene);
  if (keys || root.has("forcefield") || root.has("build")) override_forces(root, scene);
  read_biases(root, scene);
  root.reject_unknown();
  const TomlTable run = root.section("run");
  settle_pulls(run, scene);
  if (root.has("run")) settle_velocities(run, false, scene);
  if (!run.has("barostat") && !scene.run.thermostatted()) scene.run.barostat = "none";  // an imported one
  check_barostat(run, scene);
  note_net_pull(scene);
}

}  // namespace taut
