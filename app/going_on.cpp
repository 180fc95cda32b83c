#include "going_on.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <iostream>

#include "base/errors.hpp"
#include "carry_out.hpp"
#include "command_line.hpp"
#include "pictures.hpp"
#include "printing.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

// Of no consequence for what was computed.
constexpr std::array<std::string_view, 3> kOfNoConsequence = {"run.checkpoint_every",
                                                              "run.checkpoint_minutes", "run.steps"};

bool agreed(const std::string& question) {
  if (!isatty(STDIN_FILENO) || !isatty(STDERR_FILENO)) return false;
  fmt::print(stderr, "{} Go on? [y/N] ", question);
  std::string answer;
  std::getline(std::cin, answer);
  return answer == "y" || answer == "yes";
}

}  // namespace

void go_on(FolderLock lock, Checkpoint checkpoint, const KeyValues& changes, Consent consent) {
  const fs::path folder = lock.path();
  const std::unique_ptr<Simulation> simulation =
      resumed(checkpoint_file(folder).string(), checkpoint, changes);
  if (simulation->step() >= simulation->scene().run.steps && fs::exists(folder / "summary.json")) {
    if (json_alone()) return write_out(contents_of(folder / "summary.json"));
    say("{}: all {} steps are taken; `taut resume {} --steps N` takes N more\n", folder.string(),
        simulation->step(), quoted_for_shell(folder.string()));
    return;
  }
  consent.how = fmt::format("`taut resume {} --yes`", quoted_for_shell(folder.string()));
  consent.ask = agreed;
  RunFolder run_folder = resumed_folder(std::move(lock), checkpoint, *simulation, consent);
  carry_out(*simulation, &run_folder);
}

void expect_same_input(const fs::path& folder, const SceneSource& kept, const SceneSource& given) {
  const auto refuse = [&](const std::string& difference) {
    throw InputError(
        fmt::format("{}: holds a run of another input: {}; --continue goes on with the same alone, `taut "
                    "resume {}` whatever it is",
                    folder.string(), difference, quoted_for_shell(folder.string())));
  };
  // Of OpenMM's input the System and the State count, whatever their files are called: Python has other names
  // for them, and perhaps a Topology's names of atoms, which the run goes on with.
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
  const auto said = [](const KeyValues& values, const std::string& key) {
    const auto value = values.find(key);
    return value == values.end() ? "not said" : value->second;
  };
  for (const auto& [key, value] : all)
    if (std::ranges::find(kOfNoConsequence, key) == kOfNoConsequence.end() && key != "build.start" &&
        said(there, key) != said(here, key))
      refuse(fmt::format("{} is {} there, {} here", key, said(there, key), said(here, key)));
}

}  // namespace taut
