#include "systems/scene/scene_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/listen.hpp"
#include "base/nearest_name.hpp"
#include "forcefield/bonded/tabulated.hpp"
#include "forcefield/force_field.hpp"
#include "systems/builders/biases.hpp"
#include "systems/builders/builders.hpp"
#include "systems/builders/motions.hpp"
#include "systems/openmm/force_overrides.hpp"
#include "systems/scene/net_pull.hpp"
#include "systems/scene/run_keys.hpp"
#include "systems/scene/start_file.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {
namespace {

// Refuses settings that do not support struts and ropes.
void refuse_for_one_sided(const TomlTable& root, const TomlTable& run, const Scene& scene) {
  if (scene.run.minimise)
    run.fail("minimise", "moves atoms through one-sided bonds (at_least, at_most): leave it out");
  try {
    scene.method.refuse_one_sided(scene.system);
  } catch (const InputError& e) {
    root.section("method").fail("name", e.what());
  }
}

// Ewald's sum of a charged box is that of the box in a uniform background of the opposite charge.
std::string net_charge_message(const Scene& scene) {
  constexpr double kRounding = 1e-3;  // of the charges in files, all together [e]
  const auto& pairs = scene.terms.nonbonded;
  const double net = pairs && pairs->pme ? pairs->charge.sum() : 0;
  if (std::abs(net) < kRounding) return "";
  return fmt::format(
      "the charges add up to {:.4g} e, which PME neutralises by a uniform background: it shifts energy and "
      "pressure, and draws ions to where little screens them; add ions of the opposite charge",
      net);
}

// After all that holds molecules is known. Overrides of a scene that has the notes already repeat them.
void note_what_is_not_balanced(Scene& scene) {
  for (const std::string& message : {net_pull_message(scene), net_charge_message(scene)})
    if (!message.empty() && std::ranges::find(scene.notes, message) == scene.notes.end())
      scene.notes.push_back(message);
}

// Another method starts from its own defaults (scene_file.hpp).
void read_name(const TomlTable& table, MethodOptions& method) {
  std::string name(method.name());
  table.read("name", name,
             {"who holds the bonds (see `taut methods`; without [method], rattle for one-sided bonds)",
              method_names()});
  if (name != method.name()) method = default_options(name);
}

void read_options(const TomlTable& table, MethodOptions& method) {
  for (const Option& option : method.describe()) {
    About about(option.meaning, option.about.unit, option.about.range);
    about.words.assign(option.about.words.begin(), option.about.words.end());
    std::visit([&](auto* field) { table.read(option.key, *field, about); }, option.field);
  }
  std::vector<std::string_view> all;
  for (const Option& option : method.describe()) all.emplace_back(option.key);
  for (const Option& option : method.describe())
    table.require_effect(option.key, option.about.counts.read, option.about.counts.where, all);
}

void read_method(const TomlTable& root, MethodOptions& to) {
  const TomlTable method = root.section("method");
  read_name(method, to);
  read_options(method, to);
  method.reject_unknown();
}

void read_words(const TomlTable& root, Scene& scene) {
  root.read("hard_on", scene.hard_on, {"what the scene is hard on, in a sentence"});
}

void read_settings(const TomlTable& root, Scene& scene) {
  read_run(root.section("run"), scene.run);
  read_method(root, scene.method);
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

// Of [method], merged, the file's keys if its method was another than the one there is.
void forget_other_method(toml::table* method, const std::string& of_file) {
  if (!method || (*method)["name"].value_or(of_file) == of_file) return;
  for (auto key = method->begin(); key != method->end();)
    key = is_of_override(key->second) ? std::next(key) : method->erase(key);
}

// What the file says of its own start: another one, which an override names, keeps its velocities, and is relaxed only if
// overrides say so. Returns a note of what is set aside.
std::string forget_own_start(toml::table& base, const toml::table& overrides) {
  toml::table* run = base["run"].as_table();
  if (!run || !overrides["build"]["start"]) return "";
  run->erase("velocities");
  run->erase("soft_start");
  if (overrides["run"]["minimise"]) return "";
  const bool relaxed = run->get("minimise") && run->get("minimise")->value_or(false);
  run->erase("minimise");
  run->erase("minimise_force_kj_mol_nm");
  return relaxed ? "run.minimise is set aside: build.start is gone on from as it is; to relax it, --set "
                   "run.minimise=true"
                 : "";
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
  const bool another_start = bool(overrides["build"]["start"]);
  for (const char* name : {"build", "forcefield", "run", "method"})
    TomlTable(base, file.string()).section(name);  // throws if it is no section
  refuse_new_names(base, overrides);
  const auto named = base["method"]["name"].value<std::string>();
  const std::string set_aside = forget_own_start(base, overrides);
  overwrite(base, std::move(overrides));
  move_files(base, how.files);
  const TomlTable root(base, file.string(), how.keys);
  read_words(root, scene);
  read_run(root.section("run"), scene.run);
  for (const char* known : {"run", "method", "atom", "molecule", "place", "pair", "wall", "bias", "motion"})
    root.has(known);
  const TomlTable build_keys = root.section("build"), forcefield_keys = root.section("forcefield");
  const TomlTable run_keys = root.section("run");
  root.reject_unknown();
  build({root, build_keys, forcefield_keys, scene.run}, scene);
  hear();
  read_biases(root, scene);
  read_motions(root, scene);
  const std::string usual(usual_method(scene.system));
  scene.method = default_options(usual);
  forget_other_method(base["method"].as_table(), named.value_or(usual));
  read_method(root, scene.method);
  if (!scene.system.one_sided.empty()) refuse_for_one_sided(root, run_keys, scene);
  for (const auto* name : file_names(base)) scene.files.push_back(path_of(*name));
  settle_pulls(run_keys, scene);
  settle_tensions(run_keys, scene);
  settle_velocities(run_keys, another_start, scene);
  check_barostat(run_keys, scene);
  note_what_is_not_balanced(scene);
  if (!set_aside.empty()) scene.notes.push_back(set_aside);
  build_keys.reject_unknown();
  forcefield_keys.reject_unknown();
  check_tables_cover(scene.system, scene.terms, scene.start.x);
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

MethodOptions method_of(const std::vector<std::string>& overrides) {
  const toml::table table = parse_overrides(overrides);
  MethodOptions method = default_options(kUsualMethod);
  read_method(TomlTable(table, "--set"), method);
  return method;
}

MethodOptions method_in_word(const std::string& word) {
  try {
    return method_of(overrides_of_method(word));
  } catch (const LocatedError& e) {  // "--set method.sweeps=-4: method.sweeps: expected …"
    std::string why = e.what();
    for (const std::string& override_ : overrides_of_method(word)) {
      const std::string where = fmt::format("{}{}: ", kOverride, override_);
      if (why.starts_with(where)) why.erase(0, where.size());
    }
    throw InputError(fmt::format("{}: {}", word, why));
  }
}

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
    read_motions(root, scene);
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
  read_motions(root, scene);
  root.reject_unknown();
  const TomlTable run = root.section("run");
  settle_pulls(run, scene);
  settle_tensions(run, scene);
  if (root.has("run")) settle_velocities(run, false, scene);
  if (!run.has("barostat") && !scene.run.thermostatted()) scene.run.barostat = "none";  // an imported one
  check_barostat(run, scene);
  note_what_is_not_balanced(scene);
}

}  // namespace taut
