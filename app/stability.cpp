#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "command_line.hpp"
#include "commands.hpp"
#include "stability_pictures.hpp"
#include "studies/study_scene.hpp"
#include "study.hpp"
#include "systems/scene_file.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

struct StabilityArguments {
  std::string scene;
  std::vector<std::string> methods, settings;
  std::optional<double> dt_fs;
  std::optional<long> steps;
  bool quick = false, hard = false, overwrite = false;
  fs::path out = "stability";

  std::string command() const {
    CommandLine line("stability", scene);
    line.option("--methods", methods);
    line.option("--dt-fs", dt_fs);
    line.option("--set", settings);
    line.option("--steps", steps);
    line.flag("--hard", hard);
    line.flag("--quick", quick);
    line.option("--out", {out.string()});
    return line.text();
  }
};

StabilityPlan plan_of(const StabilityArguments& arguments) {
  const auto overrides = overrides_said({{"--dt-fs", "run.dt_fs", arguments.dt_fs}}, arguments.settings);
  refuse_without_effect("stability", overrides);
  StabilityPlan plan{.methods = arguments.methods, .quick = arguments.quick};
  plan.scenes.push_back(prepared_for_study(read_scene(find_scene(arguments.scene), overrides)));
  if (arguments.hard)
    for (const auto& [name, hard_on] : list_scenes(scenes_folder() / "hard"))
      plan.scenes.push_back(prepared_for_study(read_scene(scenes_folder() / "hard" / (name + ".toml"))));
  if (plan.methods.empty())
    for (const auto name : method_names()) plan.methods.emplace_back(name);
  for (const auto& name : plan.methods) default_options(name);  // refuses unknown names before anything runs
  if (plan.quick) plan.plane_steps = plan.step_steps = 200;
  plan.plane_steps = arguments.steps.value_or(plan.plane_steps);
  return plan;
}

void print_steps(const StabilityPlan& plan, const std::vector<Job>& jobs, const Ledger& ledger) {
  auto job = jobs.begin();
  fmt::print("\n{:<16} {:<12} {:>18}   {}\n", "scene", "method", "largest stable fs", "and beyond");
  for (const Scene& scene : plan.scenes)
    for (const auto& method : plan.methods) {
      const Trial& t = ledger.at((job++)->name);
      fmt::print("{:<16} {:<12} {:>18.4g}   {}\n", scene.name, method, t.figure,
                 t.failed() ? t.failure : fmt::format("none failed, up to {:g} times the scene's", kSearch));
    }
}

// What a reader of the pictures would not think of.
void print_notes(const StabilityPlan& plan, const StabilityArguments& arguments) {
  for (const Scene& scene : plan.scenes) print_notes(scene);
  if (plan.quick)
    fmt::print("  note: quick, so rough: few gains, {} steps a point, steps to 20 %\n", plan.plane_steps);
  if (arguments.hard && (arguments.dt_fs || !arguments.settings.empty()))
    fmt::print("  note: --dt-fs and --set are for {} alone, not for the hard scenes\n",
               plan.scenes.front().name);
}

void print_plane(const std::vector<Job>& plane, const Ledger& ledger) {
  const auto failed =
      std::ranges::count_if(plane, [&](const Job& job) { return ledger.at(job.name).failed(); });
  fmt::print("\n{} of {} gains failed or were refused: × in the picture, reasons in plane.csv\n", failed,
             plane.size());
}

void stability(const StabilityArguments& arguments) {
  const StabilityPlan plan = plan_of(arguments);
  const std::string line = study_line(arguments.command(), plan.scenes);
  const FolderLock lock = study_folder(arguments.out, line, arguments.overwrite);
  Ledger ledger(arguments.out / kLedger, line);
  const std::vector<Job> plane_points = plane_jobs(plan), steps = step_jobs(plan);
  std::vector<Job> jobs = plane_points;
  jobs.insert(jobs.end(), steps.begin(), steps.end());
  fmt::print("{}: {} points in the plane of gains, {} methods on {} scenes\n", plan.scenes.front().name,
             plane_points.size(), plan.methods.size(), plan.scenes.size());
  print_notes(plan, arguments);
  run_jobs(jobs, ledger);
  print_plane(plane_points, ledger);
  print_steps(plan, steps, ledger);

  StudyFiles files(arguments.out);
  files.write("limits.csv", limits_csv());
  const Picture plane = plane_picture(plan, ledger), bars = steps_picture(plan, ledger);
  files.draw(plane);
  files.draw(bars);
  write_report(
      {plan.scenes.front().name + ": where methods fail",
       arguments.command(),
       {{"Baumgarte's gains",
         fmt::format("Above: steps survived of {}. Below: energy drift where all were survived, × where not. "
                     "Dashed: the limit by the propagator's roots, for one bond; gains beyond it are "
                     "refused.",
                     plan.plane_steps),
         "plane.svg", plane.csv},
        {"The largest stable step",
         fmt::format("Of each method at its defaults, by bisection: {} steps without a failure, the total "
                     "energy within the largest kinetic energy of its start, no bond off by 10 %. Darker: "
                     "shorter than the best of its row.",
                     plan.step_steps),
         "steps.svg", bars.csv}}},
      files);
  ledger.close();
  files.tell();
}

}  // namespace

void add_stability(Commands& commands) {
  auto arguments = std::make_shared<StabilityArguments>();
  const Subcommand command =
      commands.add("stability", "find the gains and steps at which methods fail, and how",
                   [arguments] { stability(*arguments); });
  command.option("scene", arguments->scene, "a scene's file or name").required();
  command.option("--methods", arguments->methods, "which (all of `taut methods`)");
  command.flag("--hard", arguments->hard, "the scenes made to break methods (systems/hard) beside it");
  command.option("--dt-fs", arguments->dt_fs, "step length [fs]");
  command.option("--set", arguments->settings, "any key of the scene").key_values();
  command.option("--steps", arguments->steps, "at each point of the plane (2000)").positive();
  command.flag("--quick", arguments->quick, "rough: few points, few steps");
  command.option("--out", arguments->out, "folder of the pictures and report.html");
  command.flag("--overwrite", arguments->overwrite, kOverwrite);
}

}  // namespace taut
