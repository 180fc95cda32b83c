#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <memory>

#include "carry_out.hpp"
#include "commands.hpp"
#include "md/errors.hpp"
#include "md/threads.hpp"
#include "systems/checkpoint.hpp"

namespace taut {
namespace {

struct ResumeArguments {
  std::filesystem::path folder;
  std::optional<long> steps;
};

// The run as it was at its checkpoint.
Simulation recalled(const Checkpoint& checkpoint, const std::filesystem::path& folder) {
  try {
    Simulation simulation(checkpoint.source.read());
    simulation.recall(checkpoint.memory);
    if (simulation.step() != checkpoint.step) throw InputError("damaged: two numbers of steps");
    return simulation;
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", checkpoint_file(folder).string(), e.what()));
  }
}

void resume(const ResumeArguments& arguments) {
  const auto& folder = arguments.folder;
  expect_checkpoint(folder);
  FolderLock lock(folder);  // before it is read: who holds it may be writing the next
  Checkpoint checkpoint = load_checkpoint(folder);
  if (arguments.steps)
    checkpoint.source.overrides.push_back(fmt::format("run.steps={}", checkpoint.step + *arguments.steps));
  if (!std::getenv("OMP_NUM_THREADS")) use_threads(std::max(1, checkpoint.threads));
  Simulation simulation = recalled(checkpoint, folder);
  if (simulation.step() >= simulation.scene().run.steps && std::filesystem::exists(folder / "summary.json")) {
    fmt::print("{}: all {} steps are taken; --steps N takes N more\n", folder.string(), simulation.step());
    return;
  }
  RunFolder run_folder(std::move(lock), checkpoint.source, simulation, checkpoint.marks);
  carry_out(simulation, &run_folder);
}

}  // namespace

void add_resume(CLI::App& app, std::vector<std::pair<CLI::App*, Action>>& actions) {
  auto arguments = std::make_shared<ResumeArguments>();
  CLI::App* command =
      app.add_subcommand("resume", "go on with a run that was stopped or killed, or take more steps");
  command->add_option("folder", arguments->folder, "what the run was given as --out")->required();
  command
      ->add_option("--steps", arguments->steps,
                   "so many more than were taken (if not said: what is left of the run's)")
      ->check(CLI::PositiveNumber);
  actions.emplace_back(command, [arguments] { resume(*arguments); });
}

}  // namespace taut
