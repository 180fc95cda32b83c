#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "chart_pictures.hpp"
#include "command_line.hpp"
#include "commands.hpp"
#include "studies/study_scene.hpp"
#include "study.hpp"
#include "systems/scene_file.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

struct ChartArguments {
  std::string scene;
  std::vector<std::string> methods, settings;
  std::optional<double> dt_fs;
  std::optional<long> steps, drift_steps;
  std::optional<int> repeats;
  bool quick = false, overwrite = false;
  fs::path out = "chart";

  std::vector<std::string> overrides() const {
    return overrides_said({{"--dt-fs", "run.dt_fs", dt_fs}}, settings);
  }

  std::string command() const {
    CommandLine line("chart", scene);
    line.option("--methods", methods);
    line.option("--dt-fs", dt_fs);
    line.option("--set", settings);
    line.option("--repeats", repeats);
    line.option("--steps", steps);
    line.option("--drift-steps", drift_steps);
    line.flag("--quick", quick);
    line.option("--out", {out.string()});
    return line.text();
  }
};

ChartPlan plan_of(const ChartArguments& arguments) {
  refuse_without_effect("chart", arguments.settings);
  ChartPlan plan{.scene = prepared_for_study(read_scene(find_scene(arguments.scene), arguments.overrides())),
                 .methods = arguments.methods,
                 .quick = arguments.quick};
  if (plan.methods.empty())
    for (const auto name : method_names()) plan.methods.emplace_back(name);
  for (const auto& name : plan.methods) default_options(name);  // refuses unknown names before anything runs
  if (plan.quick) {
    plan.repeats = 2;
    plan.steps = 20;
    plan.drift_steps = 300;
  }
  plan.repeats = arguments.repeats.value_or(plan.repeats);
  plan.steps = arguments.steps.value_or(plan.steps);
  plan.drift_steps = arguments.drift_steps.value_or(plan.drift_steps);
  return plan;
}

// What a reader of the pictures would not think of.
void print_notes(const ChartPlan& plan) {
  print_notes(plan.scene);
  if (plan.quick)
    fmt::print("  note: quick, so rough: few settings, {} repeats of {} steps, drift over {} steps\n",
               plan.repeats, plan.steps, plan.drift_steps);
  if (plan.drift_steps < 10 * kRowsForInterval)
    fmt::print("  note: no intervals of the drift: they take {} steps, --drift-steps has {}\n",
               10 * kRowsForInterval, plan.drift_steps);
  if (!has_precisions(plan.scene))
    fmt::print("  note: no panel of precisions: the scene has no pair forces\n");
}

void print_failures(const std::string& csv) {
  const auto first = csv.find('\n') + 1;
  const auto count = std::count(csv.begin(), csv.end(), '\n') - 1;
  if (count > 0)
    fmt::print("\n{} settings failed and are not drawn (panel, setting, steps survived, reason):\n{}", count,
               csv.substr(first));
}

void chart(const ChartArguments& arguments) {
  const ChartPlan plan = plan_of(arguments);
  const std::string line = study_line(arguments.command(), {plan.scene});
  const FolderLock lock = study_folder(arguments.out, line, arguments.overwrite);
  Ledger ledger(arguments.out / kLedger, line);
  std::vector<Job> jobs;
  for (const auto& panel : {work_jobs(plan, ledger), drift_jobs(plan), order_jobs(plan),
                            length_jobs(plan, ledger), precision_jobs(plan, ledger)})
    jobs.insert(jobs.end(), panel.begin(), panel.end());
  fmt::print("{}: {} bonds, step {:g} fs; {} settings of {} methods, {} trials\n", plan.scene.name,
             plan.scene.system.bond_count(), plan.scene.run.dt_fs, plan.settings().size(),
             plan.methods.size(), jobs.size());
  print_notes(plan);
  run_jobs(jobs, ledger);

  StudyFiles files(arguments.out);
  const std::string failures = failures_csv(plan, ledger);
  ReportPage page{plan.scene.name + ": speed against accuracy", arguments.command(), {}};
  for (const auto& [picture, title, caption] : chart_pictures(plan, ledger)) {
    files.draw(picture);
    page.parts.push_back({title, caption, picture.name + ".svg", picture.csv});
  }
  page.parts.push_back({"What failed", "Settings that did not get through, and why.", "", failures});
  files.write("failures.csv", failures);
  write_report(page, files);
  print_failures(failures);
  ledger.close();
  files.tell();
}

}  // namespace

void add_chart(Commands& commands) {
  auto arguments = std::make_shared<ChartArguments>();
  const Subcommand command = commands.add("chart", "chart each method's speed against its accuracy",
                                          [arguments] { chart(*arguments); });
  command.option("scene", arguments->scene, "a scene's file or name").required();
  command.option("--methods", arguments->methods, "which (all of `taut methods`)");
  command.option("--dt-fs", arguments->dt_fs, "step length [fs]");
  command.option("--set", arguments->settings, "any key of the scene").key_values();
  command.option("--repeats", arguments->repeats, "of all that is timed (20)").positive();
  command.option("--steps", arguments->steps, "of a timed run (40)").positive();
  command.option("--drift-steps", arguments->drift_steps, "of a run whose energy is watched (4000)")
      .positive();
  command.flag("--quick", arguments->quick, "rough: few points, few repeats");
  command.option("--out", arguments->out, "folder of the pictures and report.html");
  command.flag("--overwrite", arguments->overwrite, kOverwrite);
}

}  // namespace taut
