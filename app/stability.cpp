#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/errors.hpp"
#include "base/words.hpp"
#include "printing.hpp"
#include "studies/stability_study.hpp"
#include "studies/study_scene.hpp"
#include "study.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut {
namespace {

struct StabilityArguments : StudyArguments {
  std::optional<long> steps{};
  std::vector<double> ah{}, bh{};
  bool hard = false;

  std::string command() const {
    return StudyArguments::command([&](CommandLine& line) {
      line.option("--steps", steps);
      line.option("--alpha-h", ah);
      line.option("--beta-h", bh);
      line.flag("--hard", hard);
    });
  }
};

StabilityPlan plan_of(const StabilityArguments& arguments) {
  StabilityPlan plan{.scenes = {arguments.read()}, .methods = arguments.methods_or_all()};
  if (arguments.hard)
    for (const auto& [name, hard_on] : list_scenes(scenes_folder() / "hard"))
      plan.scenes.push_back(prepared_for_study(read_scene(scenes_folder() / "hard" / (name + ".toml"))));
  if (arguments.quick) plan.make_quick();
  plan.plane_steps = arguments.steps.value_or(plan.plane_steps);
  for (const auto& [flag, given] : {std::pair{"--alpha-h", &arguments.ah}, {"--beta-h", &arguments.bh}})
    if (given->size() == 1) throw InputError(fmt::format("{}: expected at least two numbers, got one", flag));
  plan.ah = arguments.ah;
  plan.bh = arguments.bh;
  return plan;
}

void print_steps(const StabilityPlan& plan, const Ledger& ledger) {
  constexpr auto kRow = "{:<16} {:<{}} {:>10} {:>11} {:>16}   {}\n";
  std::size_t width = 16;
  for (const auto& method : plan.methods) width = std::max(width, method.size());
  say("\n");
  say(kRow, "largest step", "", width, "runs up to", "energy kept", "drift there", "and beyond");
  say(kRow, "", "", width, "[fs]", "up to [fs]", "[kT/ns]", "");
  for (std::size_t row = 0; row < plan.scenes.size(); ++row)
    for (const auto& method : plan.methods) {
      const auto& [runs, kept] = largest_steps(ledger, row, method);
      const double unit = kept.kT > 0 ? kept.kT : 1;
      const bool any = kept.figure > 0;
      say(kRow, plan.scenes[row].name, method, width, fmt::format("{:.4g}", runs.figure),
          any ? fmt::format("{:.4g}", kept.figure) : "none",
          any ? fmt::format("{:.1g} ± {:.1g}", kept.drift / unit, kept.drift_error / unit) : "–",
          runs.failed() ? runs.failure : fmt::format("none failed, up to {:g} times the scene's", kSearch));
    }
}

// The longest step at which energy is kept, and by which methods, in a sentence.
std::string verdict(const StabilityPlan& plan, const Ledger& ledger) {
  const std::string& scene = plan.scenes.front().name;
  const auto kept_up_to = [&](const std::string& method) {
    return largest_steps(ledger, 0, method).keeps_energy.figure;
  };
  double longest = 0;
  for (const auto& method : plan.methods) longest = std::max(longest, kept_up_to(method));
  if (longest == 0)
    return fmt::format("{}: no method is seen to keep the energy at any step; see the drift's errors", scene);
  std::vector<std::string> best;
  for (const auto& method : plan.methods)
    if (kept_up_to(method) > longest / 1.25) best.push_back(method);
  return fmt::format(
      "{}: take at most {:.2g} fs, the longest step at which the energy is kept, with {}; that a method runs "
      "at a "
      "longer one is no advice. Kept means that over {} steps the drift is at most 0.1 kT a nanosecond and "
      "degree "
      "of freedom but for three of its errors, and less than 1 kT with two.",
      scene, longest, fmt::join(best, ", "), 4 * plan.step_steps);
}

// Notes for readers of the pictures.
std::vector<std::string> notes_of(const StabilityPlan& plan, const StabilityArguments& arguments) {
  std::vector<std::string> notes;
  for (const Scene& scene : plan.scenes) notes.insert(notes.end(), scene.notes.begin(), scene.notes.end());
  if (plan.quick)
    notes.push_back(
        fmt::format("quick, so rough: few gains, {} steps a point, steps to 20 %", plan.plane_steps));
  if (arguments.hard && (arguments.scene.dt_fs || !arguments.scene.settings.empty()))
    notes.push_back(
        fmt::format("--dt-fs and --set are for {} alone, not for the hard scenes", plan.scenes.front().name));
  return notes;
}

void print_plane(const std::vector<Job>& plane, const Ledger& ledger) {
  const auto failed = std::count_if(plane.begin() + 1, plane.end(),
                                    [&](const Job& job) { return ledger.at(job.name).failed(); });
  say("\n{} of {} gains failed or were refused: × in the picture, reasons in plane.csv\n", failed,
      plane.size() - 1);  // one of the trials is the reference's
}

void stability(const StabilityArguments& arguments) {
  const StabilityPlan plan = plan_of(arguments);
  const Scene& scene = plan.scenes.front();
  Study study(arguments, arguments.command(), plan.scenes);
  const Ledger& ledger = study.ledger();
  const std::vector<Job> plane_points = plane_jobs(plan), steps = step_jobs(plan);
  std::vector<Job> jobs = plane_points;
  jobs.insert(jobs.end(), steps.begin(), steps.end());
  say("{}: {} in the plane of gains, {} on {}\n", scene.name, counted(std::ssize(plane_points) - 1, "point"),
      counted(std::ssize(plan.methods), "method"), counted(std::ssize(plan.scenes), "scene"));
  study.run(jobs, notes_of(plan, arguments));
  say("\n{}\n", wrapped(verdict(plan, ledger), 100, 2));
  print_steps(plan, ledger);
  print_plane(plane_points, ledger);

  const std::string limits = limits_csv();
  study.files().write("limits.csv", limits);
  study.show(
      {"plane",
       fmt::format("{}: Baumgarte at {:g} fs over the plane of its gains", scene.name, scene.run.dt_fs),
       plane_csv(plan, ledger),
       {{"limits", limits}}},
      "Baumgarte's gains",
      fmt::format("Curves: energy drift over βh. The map, above: steps survived of {}. Below: energy drift "
                  "where all were survived, × where not. "
                  "The drift of newton (rattle where bonds are one-sided) in as many steps is beside them. "
                  "Dashed: the limit by the propagator's roots, for one bond; gains beyond it are refused.",
                  plan.plane_steps),
      true);
  study.show(
      {"steps", "Largest stable step [fs], and how the next one fails", steps_csv(plan, ledger)},
      "The largest stable step",
      fmt::format("Of each method at its defaults, by bisection: {} steps without a failure, the total "
                  "energy within the largest kinetic energy of its start, no bond off by 10 %. Darker: "
                  "shorter than the best of its row. steps.csv has the largest that keeps the energy, too.",
                  plan.step_steps),
      true);
  study.conclude({verdict(plan, ledger)});
  study.finish(scene.name + ": where methods fail");
}

}  // namespace

void add_stability(Commands& commands) {
  auto arguments = std::make_shared<StabilityArguments>(StabilityArguments{{"stability"}});
  const Subcommand command =
      commands.add("stability", "find the gains and steps at which methods fail, and how",
                   [arguments] { stability(*arguments); });
  arguments->offer_first(command);
  command.flag("--hard", arguments->hard, "the scenes made to break methods (systems/hard) beside it");
  command.option("--steps", arguments->steps, "at each point of the plane (2000)").positive();
  command.option("--alpha-h", arguments->ah, "the plane's αh, rising by one factor (0.01 to 1.78)")
      .positive()
      .words(0, "NUMBER");
  command.option("--beta-h", arguments->bh, "its βh, evenly spaced (0.2 to 2.2)")
      .positive()
      .words(0, "NUMBER");
  arguments->offer_last(command, "rough: few points, few steps");
}

}  // namespace taut
