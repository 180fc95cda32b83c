#include "going_on.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <iostream>

#include "carry_out.hpp"
#include "command_line.hpp"
#include "md/errors.hpp"
#include "md/threads.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

// Of no consequence for what was computed.
constexpr std::array<std::string_view, 3> kOfNoConsequence = {"run.checkpoint_every",
                                                              "run.checkpoint_minutes", "run.steps"};

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

bool is_one_of(const auto& keys, std::string_view key) {
  return std::ranges::find(keys, key) != keys.end();
}

void refuse_fixed(const KeyValues& changes) {
  for (const auto& [key, value] : changes)
    if (!is_one_of(kMayChange, key))
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
Simulation restored(const Checkpoint& checkpoint, const fs::path& folder) {
  try {
    Simulation simulation(checkpoint.source.read());
    simulation.restore(checkpoint.memory);
    if (simulation.step() != checkpoint.step) throw InputError("damaged: two numbers of steps");
    return simulation;
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", checkpoint_file(folder).string(), e.what()));
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

bool agreed(const std::string& question) {
  if (!isatty(STDIN_FILENO) || !isatty(STDERR_FILENO)) return false;
  fmt::print(stderr, "{} Go on? [y/N] ", question);
  std::string answer;
  std::getline(std::cin, answer);
  return answer == "y" || answer == "yes";
}

// Drops the marks of what is to begin anew.
void settle_outputs(const fs::path& folder, const Simulation& simulation, const Consent& consent,
                    Marks& marks) {
  const OutputsFound found = find_outputs(folder, simulation, marks);
  const std::string yes = fmt::format("`taut resume {} --yes`", quoted_for_shell(folder.string()));
  if (!found.missing.empty() && !consent.begin_anew)
    throw OutsideError(
        fmt::format("{}: not there, or shorter than at the checkpoint of step {}: {}; put it back, or {} "
                    "begins it anew from there",
                    folder.string(), simulation.step(), fmt::join(found.missing, ", "), yes));
  for (const auto& name : found.missing) marks.erase(name);
  if (found.longer.empty() || consent.cut_back) return;
  const std::string what =
      fmt::format("{}: the checkpoint is of step {}, {} {} cut back to less than half and computed again.",
                  folder.string(), simulation.step(), fmt::join(found.longer, " and "),
                  found.longer.size() == 1 ? "is" : "are");
  if (!agreed(what)) throw InputError(fmt::format("{} If that may be: {}", what, yes));
}

}  // namespace

void go_on(FolderLock lock, Checkpoint checkpoint, const KeyValues& changes, Consent consent) {
  const fs::path folder = lock.path();
  refuse_fixed(changes);
  if (!std::getenv("OMP_NUM_THREADS")) use_threads(std::max(1, checkpoint.threads));
  Simulation simulation = restored(checkpoint, folder);
  SceneSource source = changed(checkpoint.source, simulation.scene().velocities_drawn, changes);
  if (source.overrides != checkpoint.source.overrides) change(simulation, source, changes);
  if (simulation.step() >= simulation.scene().run.steps && fs::exists(folder / "summary.json")) {
    fmt::print("{}: all {} steps are taken; `taut resume {} --steps N` takes N more\n", folder.string(),
               simulation.step(), quoted_for_shell(folder.string()));
    return;
  }
  settle_outputs(folder, simulation, consent, checkpoint.marks);
  RunFolder run_folder(std::move(lock), std::move(source), simulation, checkpoint.marks);
  carry_out(simulation, &run_folder);
}

void expect_same_input(const fs::path& folder, const SceneSource& kept, const SceneSource& given) {
  const auto refuse = [&](const std::string& difference) {
    throw InputError(
        fmt::format("{}: holds a run of another input: {}; --continue goes on with the same alone, `taut "
                    "resume {}` whatever it is",
                    folder.string(), difference, quoted_for_shell(folder.string())));
  };
  if (kept.openmm != given.openmm || kept.files.size() != given.files.size()) refuse("another kind of scene");
  for (std::size_t n = 0; n < kept.files.size(); ++n) {
    const auto &there = kept.files[n], &here = given.files[n];
    if (there.name != here.name) refuse(fmt::format("{} there, {} here", there.name, here.name));
    if (there.text != here.text) refuse(fmt::format("{} has changed since", here.name));
  }
  const KeyValues there = key_values(kept.overrides), here = key_values(given.overrides);
  KeyValues all = there;
  all.insert(here.begin(), here.end());
  const auto said = [](const KeyValues& values, const std::string& key) {
    const auto value = values.find(key);
    return value == values.end() ? "not said" : value->second;
  };
  for (const auto& [key, value] : all)
    if (!is_one_of(kOfNoConsequence, key) && key != "build.start" && said(there, key) != said(here, key))
      refuse(fmt::format("{} is {} there, {} here", key, said(there, key), said(here, key)));
}

}  // namespace taut
