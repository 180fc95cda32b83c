#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "md/aside_file.hpp"
#include "systems/scene_file.hpp"
#include "systems/studies/calibration.hpp"

namespace taut {
namespace {

struct CalibrateArguments {
  std::string scene;
  CalibrationPlan plan;
  std::optional<double> dt_fs;
  std::vector<std::string> settings;
  std::optional<std::filesystem::path> json;
};

void print_course(const char* name, const std::vector<double>& values) {
  fmt::print("  {:<12}", name);
  for (std::size_t n = 0; n < std::min<std::size_t>(values.size(), 7); ++n)
    fmt::print(" {:>8.1e}", values[n]);
  fmt::print("\n");
}

void print(const Scene& scene, const CalibrationPlan& plan, const Calibration& c) {
  const double h = scene.run.h();
  fmt::print("{}: {} bonds, h = {:g} fs; errors of {:g} put on every bond, seed {}\n\n", scene.name,
             scene.system.bond_count(), scene.run.dt_fs, plan.size, scene.run.seed);
  fmt::print("a stretch's course, rms σ/d² after\n  {:<12}", "steps");
  for (int n = 0; n < 7; ++n) fmt::print(" {:>8}", n);
  fmt::print("\n");
  print_course(plan.against.c_str(), c.reference.stretch);
  print_course("baumgarte", c.baumgarte.stretch);
  fmt::print(
      "\n{} ({}) reduces it by {:.4g} a step, over {} steps\n", plan.against,
      plan.sweeps > 0 ? fmt::format("{} sweeps", plan.sweeps) : fmt::format("tolerance {:g}", plan.tolerance),
      c.reduction_reference, c.window);
  fmt::print(
      "baumgarte, {} damping, does so with\n  alpha_per_ps = {:.6g}   beta_per_ps = {:.6g}   (αh = {:.4g}, "
      "βh = "
      "{:.4g})\n\n",
      plan.damping, c.alpha_per_ps, c.beta_per_ps, c.alpha_per_ps * h, c.beta_per_ps * h);
  fmt::print("{:34} {:>10} {:>10}\n", "", "predicted", "measured");
  const auto row = [](const char* what, double predicted, double measured) {
    fmt::print("{:34} {:>10.4g} {:>10.4g}\n", what, predicted, measured);
  };
  row("reduction a step, σ of a stretch", c.reduction_predicted, c.reduction_measured);
  row("reduction a step, σ̇ of a stretch", c.reduction_predicted, c.reduction_of_rate);
  row("reduction a step, σ of a rate", c.reduction_predicted, c.reduction_after_rate);
  row("floor, rms σ/d²", c.floor_predicted, c.floor_measured);
}

void calibrate_scene(const CalibrateArguments& arguments) {
  std::vector<std::string> overrides;
  if (arguments.dt_fs) overrides.push_back(fmt::format("run.dt_fs={}", *arguments.dt_fs));
  overrides.insert(overrides.end(), arguments.settings.begin(), arguments.settings.end());
  const Scene scene = read_scene(find_scene(arguments.scene), overrides);
  const Calibration c = calibrate(scene, arguments.plan);
  print(scene, arguments.plan, c);
  if (!arguments.json) return;
  const nlohmann::ordered_json json = {
      {"scene", scene.name},
      {"against", arguments.plan.against},
      {"sweeps", arguments.plan.sweeps},
      {"damping", arguments.plan.damping},
      {"dt_fs", scene.run.dt_fs},
      {"reduction_rattle", c.reduction_reference},
      {"alpha_per_ps", c.alpha_per_ps},
      {"beta_per_ps", c.beta_per_ps},
      {"reduction_predicted", c.reduction_predicted},
      {"reduction_measured", c.reduction_measured},
      {"reduction_measured_rate", c.reduction_of_rate},
      {"floor_predicted", c.floor_predicted},
      {"floor_measured", c.floor_measured},
  };
  AsideFile file(*arguments.json);
  file.write(json.dump(2) + "\n");
  file.commit();
}

}  // namespace

void add_calibrate(CLI::App& app, std::vector<std::pair<CLI::App*, Action>>& actions) {
  auto arguments = std::make_shared<CalibrateArguments>();
  CLI::App* command =
      app.add_subcommand("calibrate", "find the gains with which Baumgarte reduces errors as RATTLE does");
  command->add_option("scene", arguments->scene, "a scene's file or name")->required();
  command->add_option("--against", arguments->plan.against, "rattle, shake or newton")->capture_default_str();
  auto* tolerance =
      command->add_option("--tolerance", arguments->plan.tolerance, "of that method")->capture_default_str();
  command
      ->add_option("--sweeps", arguments->plan.sweeps,
                   "that method takes just so many, in place of a tolerance")
      ->excludes(tolerance);
  command->add_option("--damping", arguments->plan.damping, "centred, implicit or lagged")
      ->capture_default_str();
  command->add_option("--dt-fs", arguments->dt_fs, "step length [fs]");
  command->add_option("--set", arguments->settings, "any key of the scene")->type_name("KEY=VALUE");
  command->add_option("--json", arguments->json, "write the figures there");
  actions.emplace_back(command, [arguments] { calibrate_scene(*arguments); });
}

}  // namespace taut
