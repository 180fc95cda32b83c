#include "simulation/open_run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>

#include "base/errors.hpp"
#include "base/listen.hpp"
#include "base/threads.hpp"
#include "base/usable_cores.hpp"
#include "files/folder.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 17> kMayChange = {
    "run.barostat",           "run.barostat_every",
    "run.barostat_ps",        "run.checkpoint_every",
    "run.checkpoint_minutes", "run.compressibility_per_bar",
    "run.coupling",           "run.dt_fs",
    "run.friction_per_ps",    "run.log_every",
    "run.pressure_bar",       "run.steps",
    "run.temperature_k",      "run.thermostat",
    "run.thermostat_ps",      "run.trajectory",
    "run.trajectory_every"};

// These may differ between two runs of the same input: they do not change what is computed.
constexpr std::array<std::string_view, 4> kSameInputIgnores = {"build.start", "run.checkpoint_every",
                                                               "run.checkpoint_minutes", "run.steps"};

// ---- A new run

void refuse_outputs_without_folder(const RunRequest& request) {
  if (request.mode != RunMode::kNew)
    throw InputError(
        fmt::format("{}: of which folder? give {}",
                    request.mode == RunMode::kContinue ? request.names.go_on : request.names.overwrite,
                    request.names.folder));
  const RunSettings& run = request.scene->run;
  const char* key = run.trajectory_every > 0                                     ? "trajectory_every"
                    : run.checkpoint_every > 0                                   ? "checkpoint_every"
                    : run.checkpoint_minutes != RunSettings{}.checkpoint_minutes ? "checkpoint_minutes"
                                                                                 : nullptr;
  if (key) throw InputError(fmt::format("run.{}: nowhere to write, give {}", key, request.names.folder));
}

void refuse_other_run(const RunRequest& request) {
  const std::vector<std::string> files = run_files(request.folder);
  if (request.mode != RunMode::kNew || files.empty()) return;
  throw InputError(fmt::format(
      "{}: holds a run ({}); {} goes on with it, {} first moves it aside, to {}.1 or the next number that is "
      "free",
      request.folder.string(), fmt::join(files, ", "), request.names.go_on, request.names.overwrite,
      backup_base(request.folder).string()));
}

int threads_of_new_run(const RunRequest& request) {
  if (request.threads) return *request.threads;
  if (request.may_take_all_cores && !asked_threads() && has_threads())
    return threads_worth_waking(request.scene->system.atoms());
  return available_threads();
}

OpenRun open_new(RunRequest& request) {
  if (request.folder.empty())
    refuse_outputs_without_folder(request);
  else
    refuse_other_run(request);  // before a start that may take long to relax
  OpenRun run{std::move(request.source), nullptr, {}};
  for (const auto& [key, value] : request.usual) run.source.overrides.push_back(key + "=" + value);
  const int threads = threads_of_new_run(request);
  run.simulation = std::make_unique<Simulation>(std::move(*request.scene), threads);
  if (request.folder.empty()) return run;
  FolderLock lock(request.folder);
  refuse_other_run(request);  // another process may have been faster
  run.folder.emplace(std::move(lock), run.source, *run.simulation);
  return run;
}

// ---- A run that continues

void refuse_other_input(const RunRequest& request, const SceneSource& kept) {
  const SceneSource& given = request.source;
  const auto refuse = [&](const std::string& difference) {
    throw InputError(
        fmt::format("{}: holds a run of another input: {}; {} goes on with the same alone, {} whatever it is",
                    request.folder.string(), difference, request.names.go_on, request.names.resume));
  };
  // OpenMM's System and State count, whatever their files are called: Python names them otherwise, and may add
  // a file with a Topology's names of atoms.
  const bool openmm = given.openmm;
  const std::size_t files = openmm ? 2 : given.files.size();
  if (kept.openmm != openmm || (openmm ? kept.files.size() < files : kept.files.size() != files))
    refuse("another kind of scene");
  for (std::size_t n = 0; n < files; ++n) {
    const auto &there = kept.files[n], &here = given.files[n];
    if (!openmm && there.name != here.name) refuse(fmt::format("{} there, {} here", there.name, here.name));
    if (there.text != here.text) refuse(fmt::format("{} has changed since", here.name));
  }
  const KeyValues there = key_values(kept.overrides), here = key_values(given.overrides);
  KeyValues all = there;
  all.insert(here.begin(), here.end());
  for (const auto& [key, value] : request.usual) all.erase(key);
  const auto value_in = [](const KeyValues& values, const std::string& key) {
    const auto value = values.find(key);
    return value == values.end() ? "not said" : value->second;
  };
  for (const auto& [key, value] : all)
    if (std::ranges::find(kSameInputIgnores, key) == kSameInputIgnores.end() &&
        value_in(there, key) != value_in(here, key))
      refuse(fmt::format("{} is {} there, {} here", key, value_in(there, key), value_in(here, key)));
}

bool is_of_method(const std::string& key) {
  return key.starts_with("method.");
}

bool is_of_step(const KeyValues::value_type& change) {
  return is_of_method(change.first) || change.first == "run.dt_fs";
}

void refuse_fixed(const KeyValues& changes) {
  for (const auto& [key, value] : changes)
    if (std::ranges::find(kMayChange, key) == kMayChange.end() && !is_of_method(key))
      throw InputError(fmt::format(
          "--set {}={}: {} cannot change in a run that has begun, only keys of [method] and {}; a new "
          "run can start where this one ended: --set build.start=final.start.toml",
          key, value, key, fmt::join(kMayChange, ", ")));
}

// All changes to the keys, the number of steps included.
KeyValues changes_of(const RunRequest& request, const Checkpoint& checkpoint) {
  KeyValues changes = request.changes;
  if (request.scene) changes["run.steps"] = std::to_string(request.scene->run.steps);
  if (request.more_steps) {
    if (*request.more_steps > std::numeric_limits<long>::max() - checkpoint.step)
      throw InputError(fmt::format("--steps {}: with the {} that are taken more than can be counted",
                                   *request.more_steps, checkpoint.step));
    changes["run.steps"] = std::to_string(checkpoint.step + *request.more_steps);
  }
  return changes;
}

std::unique_ptr<Simulation> restore_simulation(const RunRequest& request, const Checkpoint& checkpoint) {
  const std::string where =
      request.folder.empty() ? "the checkpoint" : checkpoint_file(request.folder).string();
  const std::optional<int> asked = request.threads ? request.threads : asked_threads();
  try {
    const ThreadScope scope(asked.value_or(std::max(1, checkpoint.threads)));
    Scene scene = checkpoint.source.read();
    checkpoint.source.bring(request.forces, scene);
    auto simulation = std::make_unique<Simulation>(std::move(scene), available_threads());
    simulation->restore(checkpoint.memory);
    if (simulation->step() != checkpoint.step) throw InputError("damaged: two numbers of steps");
    return simulation;
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", where, e.what()));
  }
}

// A method, a thermostat or a barostat that is replaced takes its settings with it.
std::vector<std::string> changed_overrides(const std::vector<std::string>& overrides, bool velocities_drawn,
                                           const KeyValues& changes) {
  KeyValues values = key_values(overrides);
  if (changes.contains("method.name"))
    std::erase_if(values, [](const auto& value) { return is_of_method(value.first); });
  if (changes.contains("run.thermostat"))
    for (const char* key : {"run.thermostat_ps", "run.friction_per_ps"}) values.erase(key);
  if (changes.contains("run.barostat"))
    for (const char* key : {"run.barostat_every", "run.barostat_ps", "run.compressibility_per_bar",
                            "run.coupling", "run.pressure_bar"})
      values.erase(key);
  const auto thermostat = changes.find("run.thermostat");
  if (thermostat != changes.end() && thermostat->second == toml_quoted("none") && !velocities_drawn)
    values.erase("run.temperature_k");
  for (const auto& [key, value] : changes) values[key] = value;
  if (const auto every = values.find("run.trajectory_every"); every != values.end() && every->second == "0")
    values.erase("run.trajectory");
  return overrides_of(values);
}

// Erases the marks of outputs that start anew.
void reconcile_outputs(const RunRequest& request, const Simulation& simulation, Marks& marks) {
  const OutputsFound found = find_outputs(request.folder, simulation, marks);
  if (!found.missing.empty() && !request.accept)
    throw OutsideError(fmt::format(
        "{}: not there, or shorter than at the checkpoint of step {}: {}; put it back, or {} "
        "begins it anew from there",
        request.folder.string(), simulation.step(), fmt::join(found.missing, ", "), request.names.accept));
  for (const auto& name : found.missing) marks.erase(name);
  if (found.longer.empty() || request.accept || request.mode == RunMode::kContinue) return;
  const std::string what =
      fmt::format("{}: the checkpoint is of step {}, {} {} cut back to less than half and computed again.",
                  request.folder.string(), simulation.step(), fmt::join(found.longer, " and "),
                  found.longer.size() == 1 ? "is" : "are");
  if (!request.ask || !request.ask(what))
    throw InputError(fmt::format("{} If that may be: {}", what, request.names.accept));
}

OpenRun open_begun(RunRequest& request) {
  std::optional<FolderLock> lock;
  if (!request.folder.empty()) {
    expect_checkpoint(request.folder);
    lock.emplace(request.folder);  // before reading: the process that holds it may be writing a checkpoint
  }
  Checkpoint checkpoint = lock ? load_checkpoint(request.folder) : read_checkpoint(request.checkpoint);
  if (request.mode == RunMode::kContinue) refuse_other_input(request, checkpoint.source);
  const KeyValues changes = changes_of(request, checkpoint);
  OpenRun run{checkpoint.source, restore_simulation(request, checkpoint), {}};
  run.history = std::move(checkpoint.history);
  change_settings(*run.simulation, run.source, changes);
  if (!lock) return run;
  run.finished = request.leave_finished && run.simulation->step() >= run.simulation->scene().run.steps &&
                 fs::exists(request.folder / "summary.json");
  if (run.finished) return run;
  reconcile_outputs(request, *run.simulation, checkpoint.marks);
  run.folder.emplace(std::move(*lock), run.source, *run.simulation, checkpoint.marks);
  return run;
}

}  // namespace

void change_settings(Simulation& simulation, SceneSource& source, const KeyValues& changes) {
  refuse_fixed(changes);
  std::vector<std::string> overrides =
      changed_overrides(source.overrides, simulation.scene().velocities_drawn, changes);
  if (overrides == source.overrides) return;
  SceneSource changed = source;
  changed.overrides = std::move(overrides);
  const Scene scene = changed.read();
  const ListenScope deaf;  // what changes is changed whole
  const RunSettings before = simulation.scene().run, after = scene.run;
  // The frames of one file are equally spaced from its start to its end.
  if (before.trajectory_every > 0 && after.trajectory_every > 0 &&
      before.trajectory_every != after.trajectory_every)
    throw InputError(
        fmt::format("run.trajectory_every: the frames written so far are {} steps apart, they cannot go on "
                    "{} apart; 0 goes on without",
                    before.trajectory_every, after.trajectory_every));
  if (before.trajectory_every > 0 && after.trajectory_every > 0 && before.dt_fs != after.dt_fs)
    throw InputError(fmt::format(
        "run.dt_fs: the frames written so far are {} steps of {:g} fs apart, they cannot go on {:g} "
        "fs a step; run.trajectory_every = 0 goes on without",
        before.trajectory_every, before.dt_fs, after.dt_fs));
  if (changes.contains("run.temperature_k") && !after.langevin() && !after.rescaling())
    throw InputError(
        "run.temperature_k: no thermostat holds it, and velocities are drawn at the start alone");
  if (std::ranges::any_of(changes, is_of_step)) simulation.change_step(after.dt_fs, scene.method);
  simulation.change(after);
  source.overrides = std::move(changed.overrides);  // not before: what is refused leaves no trace
}

OpenRun open_run(RunRequest request) {
  const bool begun =
      request.mode == RunMode::kResume || (request.mode == RunMode::kContinue && !request.folder.empty() &&
                                           fs::exists(checkpoint_file(request.folder)));
  return begun ? open_begun(request) : open_new(request);
}

}  // namespace taut
