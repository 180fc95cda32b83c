#include "systems/scene_file.hpp"

#include "forcefield/force_field.hpp"
#include "md/errors.hpp"
#include "systems/builders/builders.hpp"
#include "systems/toml_reader.hpp"

namespace taut {
namespace {

void read_run(const TomlTable& table, RunSettings& run) {
  table.read("dt_fs", run.dt_fs, kPositive);
  table.read("steps", run.steps, kNotNegative);
  table.read("temperature_k", run.temperature_k, kNotNegative);
  table.read("seed", run.seed, kNotNegative);
  table.read("log_every", run.log_every, Range{.min = 1});
  table.read("remove_momentum_every", run.remove_momentum_every, kNotNegative);
  table.read("trajectory_every", run.trajectory_every, kNotNegative);
  if (table.has("trajectory")) run.trajectory = table.choice("trajectory", {"dcd", "h5md", "both"});
  table.read("checkpoint_every", run.checkpoint_every, kNotNegative);
  table.read("checkpoint_minutes", run.checkpoint_minutes, kNotNegative);
  if (table.has("redundant")) run.redundant = table.choice("redundant", {"refuse", "drop"});
  if (table.has("thermostat")) run.thermostat = table.choice("thermostat", {"none", "langevin", "rescaling"});
  table.read("thermostat_ps", run.thermostat_ps, kNotNegative);
  table.read("friction_per_ps", run.friction_per_ps, kNotNegative);
  table.read("minimise", run.minimise);
  table.read("minimise_force_kj_mol_nm", run.minimise_force, kPositive);
  const char* key = table.has("thermostat") ? "thermostat" : "thermostat_ps";
  if ((run.langevin() || run.rescaling()) && run.temperature_k == 0)
    table.fail(key, "a thermostat needs a run.temperature_k above 0");
  if (run.rescaling() && run.thermostat_ps == 0)
    table.fail("thermostat", "rescaling needs its relaxation time, run.thermostat_ps above 0");
  table.reject_unknown();
}

// Another name sets out from that method's defaults: see scene_file.hpp.
void read_method(const TomlTable& table, MethodOptions& method) {
  std::string name(method_name(method));
  table.read("name", name);
  if (name != method_name(method)) try {
      method = default_options(name);
    } catch (const InputError& e) {
      table.fail("name", e.what());
    }
  const auto read_key = [&](const char* key, auto& field, const char*) { table.read(key, field); };
  std::visit([&](auto& options) { options.describe(read_key); }, method);
  table.reject_unknown();
}

void read_settings(const TomlTable& root, Scene& scene) {
  read_run(root.section("run"), scene.run);
  read_method(root.section("method"), scene.method);
}

Scene read_parsed(const std::filesystem::path& file, toml::table base, toml::table overrides) {
  Scene scene;
  scene.name = file.stem().string();
  scene.files = {file};
  scene.method = default_options("rattle");
  read_settings(TomlTable(base, file.string()), scene);
  read_settings(TomlTable(overrides, "--set"), scene);

  lay_over(base, std::move(overrides));
  const TomlTable root(base, file.string());
  scene.hard_on = root.get<std::string>("hard_on");
  for (const char* read_above : {"run", "method"}) root.has(read_above);
  const TomlTable build_keys = root.section("build"), forcefield_keys = root.section("forcefield");
  root.reject_unknown();
  build({build_keys, forcefield_keys, scene.run}, scene);
  if (std::filesystem::path start; build_keys.read("start", start)) scene.files.push_back(start);
  build_keys.reject_unknown();
  forcefield_keys.reject_unknown();
  // Refuses what does not fit together while the file is known.
  [[maybe_unused]] const ForceField fitting(scene.system, scene.terms);
  return scene;
}

}  // namespace

Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  return read_scene(parse_toml_file(file), file, overrides);
}

Scene read_scene(toml::table&& table, const std::filesystem::path& file,
                 const std::vector<std::string>& overrides) {
  try {
    return read_parsed(file, std::move(table), parse_overrides(overrides));
  } catch (const LocatedError&) {
    throw;
  } catch (const InputError& e) {
    throw LocatedError(file.string() + ": " + e.what());
  }
}

void apply_overrides(Scene& scene, const std::vector<std::string>& overrides) {
  const toml::table table = parse_overrides(overrides);
  const TomlTable root(table, "--set");
  read_settings(root, scene);
  root.reject_unknown();
}

}  // namespace taut
