#include "systems/scene_file.hpp"

#include "forcefield/force_field.hpp"
#include "md/errors.hpp"
#include "systems/builders/builders.hpp"
#include "systems/toml_reader.hpp"
#include "systems/velocities.hpp"

namespace taut {
namespace {

void read_barostat(const TomlTable& table, RunSettings& run) {
  if (table.has("barostat")) run.barostat = table.choice("barostat", {"none", "c-rescale", "monte-carlo"});
  table.read("pressure_bar", run.pressure_bar);
  table.read("barostat_every", run.barostat_every, Range{.min = 1});
  table.read("barostat_ps", run.barostat_ps, kPositive);
  table.read("compressibility_per_bar", run.compressibility_per_bar, kPositive);
  if (table.has("coupling"))
    run.coupling = table.choice("coupling", {"isotropic", "semi-isotropic", "anisotropic"});

  for (const char* key : {"pressure_bar", "barostat_every"})
    table.counts(key, run.barostat != "none", "with run.barostat = \"c-rescale\" or \"monte-carlo\"");
  for (const char* key : {"barostat_ps", "compressibility_per_bar", "coupling"})
    table.counts(key, run.barostat == "c-rescale", "with run.barostat = \"c-rescale\"");
}

// Of a scene that is there: what a barostat needs.
void check_barostat(const TomlTable& run, const Scene& scene) {
  if (scene.run.barostat == "none") return;
  if (!scene.run.thermostatted())
    run.fail("barostat", "a barostat needs a thermostat: run.thermostat = \"langevin\" or \"rescaling\"");
  if (!scene.start.box.periodic()) run.fail("barostat", "there is no box to change; leave the key out");
  if (!scene.closed())
    run.fail("barostat",
             "an anchored atom (mass 0), gravity or a pull holds on to what the box would move; leave the "
             "key out");
}

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
  if (table.has("velocities")) run.velocities = table.choice("velocities", {"keep", "draw"});

  table.counts("minimise_force_kj_mol_nm", run.minimise, "with run.minimise = true");
  table.counts("trajectory", run.trajectory_every > 0, "with run.trajectory_every above 0");
  table.counts("friction_per_ps", run.langevin(), "with run.thermostat = \"langevin\"");
  table.counts("thermostat_ps", run.rescaling() || run.thermostat_ps == 0,
               "with run.thermostat = \"rescaling\"");
  const char* key = table.has("thermostat") ? "thermostat" : "thermostat_ps";
  if (run.thermostatted() && run.temperature_k == 0)
    table.fail(key, "a thermostat needs a run.temperature_k above 0");
  if (run.rescaling() && run.thermostat_ps == 0)
    table.fail("thermostat", "rescaling needs its relaxation time, run.thermostat_ps above 0");
  read_barostat(table, run);
  table.reject_unknown();
}

// Another name sets out from that method's defaults: see scene_file.hpp.
void read_method(const TomlTable& table, MethodOptions& method) {
  std::string name(method.name());
  table.read("name", name);
  if (name != method.name()) try {
      method = default_options(name);
    } catch (const InputError& e) {
      table.fail("name", e.what());
    }
  for (const Option& option : method.describe())
    std::visit(
        [&]<class T>(T* field) {
          if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, std::string>)
            table.read(option.key, *field);
          else
            table.read(option.key, *field, option.about.range);
        },
        option.field);
  for (const Option& option : method.describe())
    table.counts(option.key, option.about.counts.read, option.about.counts.where);
  table.reject_unknown();
}

// Of a scene whose atoms are placed. What the file says for a start, or for velocities, that overrides have
// replaced is set aside; what is said and does nothing is refused.
void settle_velocities(const TomlTable& run, bool set_aside, Scene& scene) {
  const RunSettings& settings = scene.run;
  if (settings.velocities == "draw" && settings.temperature_k == 0)
    run.fail("velocities", "drawn at run.temperature_k, which is 0; give one, or run.velocities = \"keep\"");
  give_velocities(scene);
  const bool draws = scene.velocities_drawn || settings.thermostatted();
  if (run.overridden("temperature_k") || !set_aside)
    run.counts("temperature_k", draws || settings.temperature_k == 0,
               "with a thermostat or run.velocities = \"draw\": the start has velocities, which are kept");
  if (run.overridden("seed"))
    run.counts("seed", draws || scene.positions_drawn,
               "where something is drawn: here positions and velocities are the start's");
}

void read_settings(const TomlTable& root, Scene& scene) {
  read_run(root.section("run"), scene.run);
  read_method(root.section("method"), scene.method);
}

// The start that is meant has moved; who names it, the file or an override, stays.
void move_start(toml::table& root, const std::filesystem::path& start) {
  if (auto named = root["build"]["start"].as_string()) *named = start.string();
}

Scene read_parsed(const std::filesystem::path& file, toml::table base, toml::table overrides,
                  const std::filesystem::path& start) {
  Scene scene;
  scene.name = file.stem().string();
  scene.files = {file};
  scene.method = default_options("rattle");
  read_settings(TomlTable(base, file.string()), scene);
  const RunSettings of_file = scene.run;
  const bool another_start = bool(overrides["build"]["start"]);
  if (another_start) scene.run.velocities.clear();
  read_settings(TomlTable(overrides, "--set"), scene);

  lay_over(base, std::move(overrides));
  if (!start.empty()) move_start(base, start);
  const TomlTable root(base, file.string());
  scene.hard_on = root.get<std::string>("hard_on");
  for (const char* read_above : {"run", "method"}) root.has(read_above);
  const TomlTable build_keys = root.section("build"), forcefield_keys = root.section("forcefield");
  const TomlTable run_keys = root.section("run");
  root.reject_unknown();
  build({build_keys, forcefield_keys, scene.run}, scene);
  if (std::filesystem::path named; build_keys.read("start", named)) scene.files.push_back(named);
  settle_velocities(run_keys,
                    another_start || run_keys.overridden("velocities") || of_file.thermostatted() ||
                        of_file.velocities == "draw",
                    scene);
  check_barostat(run_keys, scene);
  build_keys.reject_unknown();
  forcefield_keys.reject_unknown();
  // Refuses what does not fit together while the file is known.
  [[maybe_unused]] const ForceField fitting(scene.system, scene.start.box, scene.terms);
  return scene;
}

}  // namespace

Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                 const std::filesystem::path& start) {
  return read_scene(parse_toml_file(file), file, overrides, start);
}

Scene read_scene(toml::table&& table, const std::filesystem::path& file,
                 const std::vector<std::string>& overrides, const std::filesystem::path& start) {
  try {
    return read_parsed(file, std::move(table), parse_overrides(overrides), start);
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
  const TomlTable run = root.section("run");
  if (root.has("run")) settle_velocities(run, false, scene);
  if (!run.has("barostat") && !scene.run.thermostatted()) scene.run.barostat = "none";  // what was imported
  check_barostat(run, scene);
}

}  // namespace taut
