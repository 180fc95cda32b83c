#include "simulation/resumption.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "base/errors.hpp"
#include "base/threads.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 16> kMayChange = {"run.barostat",
                                                         "run.barostat_every",
                                                         "run.barostat_ps",
                                                         "run.checkpoint_every",
                                                         "run.checkpoint_minutes",
                                                         "run.compressibility_per_bar",
                                                         "run.coupling",
                                                         "run.friction_per_ps",
                                                         "run.log_every",
                                                         "run.pressure_bar",
                                                         "run.steps",
                                                         "run.temperature_k",
                                                         "run.thermostat",
                                                         "run.thermostat_ps",
                                                         "run.trajectory",
                                                         "run.trajectory_every"};

void refuse_fixed(const KeyValues& changes) {
  for (const auto& [key, value] : changes)
    if (std::ranges::find(kMayChange, key) == kMayChange.end())
      throw InputError(
          fmt::format("--set {}={}: {} cannot change in a run that has begun, only {}; a new run can start "
                      "where this one ended: --set build.start=final.start.toml",
                      key, value, key, fmt::join(kMayChange, ", ")));
}

// Frames of a file are as many steps apart at its end as at its start.
void refuse_other_frames(const RunSettings& before, const RunSettings& after) {
  if (before.trajectory_every > 0 && after.trajectory_every > 0 &&
      before.trajectory_every != after.trajectory_every)
    throw InputError(
        fmt::format("run.trajectory_every: the frames written so far are {} steps apart, they cannot go on "
                    "{} apart; 0 goes on without",
                    before.trajectory_every, after.trajectory_every));
}

// The run as it was at its checkpoint.
std::unique_ptr<Simulation> restored(const std::string& where, const Checkpoint& checkpoint,
                                     const std::vector<std::shared_ptr<OwnField>>& own, int threads) {
  try {
    const ThreadScope scope(threads);
    Scene scene = checkpoint.source.read();
    checkpoint.source.bring(own, scene);
    auto simulation = std::make_unique<Simulation>(std::move(scene));
    simulation->restore(checkpoint.memory);
    if (simulation->step() != checkpoint.step) throw InputError("damaged: two numbers of steps");
    return simulation;
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", where, e.what()));
  }
}

// What a thermostat or a barostat leaves behind that is taken away goes with it.
SceneSource changed(SceneSource source, bool velocities_drawn, const KeyValues& changes) {
  KeyValues values = key_values(source.overrides);
  if (changes.contains("run.thermostat"))
    for (const char* of_the_old : {"run.thermostat_ps", "run.friction_per_ps"}) values.erase(of_the_old);
  if (changes.contains("run.barostat"))
    for (const char* of_the_old : {"run.barostat_every", "run.barostat_ps", "run.compressibility_per_bar",
                                   "run.coupling", "run.pressure_bar"})
      values.erase(of_the_old);
  const auto thermostat = changes.find("run.thermostat");
  if (thermostat != changes.end() && thermostat->second == toml_quoted("none") && !velocities_drawn)
    values.erase("run.temperature_k");
  for (const auto& [key, value] : changes) values[key] = value;
  if (const auto every = values.find("run.trajectory_every"); every != values.end() && every->second == "0")
    values.erase("run.trajectory");
  source.overrides = overrides_of(values);
  return source;
}

void change(Simulation& simulation, const SceneSource& source, const KeyValues& changes) {
  const RunSettings after = source.read().run;
  refuse_other_frames(simulation.scene().run, after);
  if (changes.contains("run.temperature_k") && !after.langevin() && !after.rescaling())
    throw InputError(
        "run.temperature_k: no thermostat holds it, and velocities are drawn at the start alone");
  simulation.change(after);
}

// Drops the marks of what is to begin anew.
void settle_outputs(const fs::path& folder, const Simulation& simulation, const Consent& consent,
                    Marks& marks) {
  const OutputsFound found = find_outputs(folder, simulation, marks);
  if (!found.missing.empty() && !consent.begin_anew)
    throw OutsideError(
        fmt::format("{}: not there, or shorter than at the checkpoint of step {}: {}; put it back, or {} "
                    "begins it anew from there",
                    folder.string(), simulation.step(), fmt::join(found.missing, ", "), consent.how));
  for (const auto& name : found.missing) marks.erase(name);
  if (found.longer.empty() || consent.cut_back) return;
  const std::string what =
      fmt::format("{}: the checkpoint is of step {}, {} {} cut back to less than half and computed again.",
                  folder.string(), simulation.step(), fmt::join(found.longer, " and "),
                  found.longer.size() == 1 ? "is" : "are");
  if (!consent.ask || !consent.ask(what))
    throw InputError(fmt::format("{} If that may be: {}", what, consent.how));
}

}  // namespace

std::unique_ptr<Simulation> resumed(const std::string& where, Checkpoint& checkpoint,
                                    const KeyValues& changes,
                                    const std::vector<std::shared_ptr<OwnField>>& own,
                                    std::optional<int> threads) {
  refuse_fixed(changes);
  if (!threads) threads = asked_threads();
  std::unique_ptr<Simulation> simulation =
      restored(where, checkpoint, own, threads.value_or(std::max(1, checkpoint.threads)));
  SceneSource source = changed(checkpoint.source, simulation->scene().velocities_drawn, changes);
  if (source.overrides != checkpoint.source.overrides) change(*simulation, source, changes);
  checkpoint.source = std::move(source);
  return simulation;
}

RunFolder resumed_folder(FolderLock lock, const Checkpoint& checkpoint, const Simulation& simulation,
                         const Consent& consent) {
  Marks marks = checkpoint.marks;
  settle_outputs(lock.path(), simulation, consent, marks);
  return {std::move(lock), checkpoint.source, simulation, marks};
}

}  // namespace taut
