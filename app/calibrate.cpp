#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "command_line.hpp"
#include "commands.hpp"
#include "files/atomic_file.hpp"
#include "printing.hpp"
#include "scene_argument.hpp"
#include "studies/calibration.hpp"
#include "studies/study_scene.hpp"
#include "study.hpp"
#include "words.hpp"

namespace taut {
namespace {

struct CalibrateArguments {
  SceneArgument scene;
  CalibrationPlan plan;
  std::optional<std::filesystem::path> json;
  bool overwrite = false;
};

void print_course(const char* name, const std::vector<double>& values) {
  say("  {:<12}", name);
  for (std::size_t n = 0; n < std::min<std::size_t>(values.size(), 7); ++n) say(" {:>8.1e}", values[n]);
  say("\n");
}

// Prints the fraction of an error that so many sweeps leave in theory, and the measured one; one line per
// kind of molecule.
void print_shapes(const Calibration& c) {
  constexpr std::size_t kMost = 6;
  for (std::size_t n = 0; n < std::min(c.shapes.size(), kMost); ++n) {
    say("  its {}\n", c.shapes[n].name);
    print_course("  predicted", c.shapes[n].foretold);
    print_course("  measured", c.shapes[n].measured);
  }
  if (c.shapes.size() > kMost) say("  and {} shapes more (--json has all)\n", c.shapes.size() - kMost);
}

// Returns the options with which `taut run` uses the measured method.
std::string run_line(const CalibrateArguments& arguments, const Calibration& c) {
  CommandLine line = arguments.scene.line("run");
  line.option("--dt-fs", arguments.scene.dt_fs);
  std::vector<std::string> settings = arguments.scene.settings;
  std::ranges::copy(settings_of(c), std::back_inserter(settings));
  line.option("--set", settings);
  return line.text();
}

void print(const Scene& scene, const CalibrateArguments& arguments, const Calibration& c) {
  const CalibrationPlan& plan = arguments.plan;
  const double h = scene.run.h();
  say("{}: {}, h = {:g} fs; errors of {:g} put on every bond, seed {}\n", scene.name,
      counted(scene.system.bond_count(), "bond"), scene.run.dt_fs, plan.size, scene.run.seed);
  print_notes(scene.notes);
  say("\na stretch's course, rms σ/d² after\n  {:<12}", "steps");
  for (int n = 0; n < 7; ++n) say(" {:>8}", n);
  say("\n");
  print_course(plan.against.c_str(), c.reference.stretch);
  print_course("baumgarte", c.baumgarte.stretch);
  print_course("  predicted", c.foretold);
  print_shapes(c);
  say("\n{} ({}) reduces it by {:.4g} a step, {}\n", plan.against,
      plan.sweeps > 0 ? fmt::format("{} sweeps", plan.sweeps) : fmt::format("tolerance {:g}", plan.tolerance),
      c.reduction_reference,
      plan.copies == "slowest" ? "where its sweeps leave most"
      : plan.copies == "first" ? "its first"
                               : fmt::format("over {} steps", c.window));
  say("baumgarte, {} law, does so with\n"
      "  alpha_per_ps = {:.6g}   beta_per_ps = {:.6g}   (αh = {:.4g}, βh = {:.4g}), that is\n  {}\n\n",
      plan.damping, c.alpha_per_ps, c.beta_per_ps, c.alpha_per_ps * h, c.beta_per_ps * h,
      run_line(arguments, c));
  say("{:34} {:>10} {:>10}\n", "", "predicted", "measured");
  const auto row = [](const char* what, double predicted, double measured) {
    say("{:34} {:>10.4g} {:>10.4g}\n", what, predicted, measured);
  };
  row("reduction a step, σ of a stretch", c.of_stretch.predicted, c.of_stretch.measured);
  row("reduction a step, σ̇ of a stretch", c.of_rate.predicted, c.of_rate.measured);
  row("reduction a step, σ of a rate", c.after_rate.predicted, c.after_rate.measured);
  row("floor, rms σ/d²", c.floor_predicted, c.floor_measured);
  if (const std::string why = disagreement(plan, c); !why.empty()) say("\n{}\n", why);
}

void calibrate_scene(const CalibrateArguments& arguments) {
  refuse_without_effect("calibrate", arguments.scene.overrides());
  if (arguments.json && arguments.json != "-") expect_no_file({*arguments.json}, arguments.overwrite);
  if (arguments.json == "-") print_json_alone();
  const Scene scene = prepared_for_study(arguments.scene.read());
  const Calibration c = calibrate(scene, arguments.plan);
  print(scene, arguments, c);
  if (!arguments.json) return;
  nlohmann::ordered_json json = {
      {"scene", scene.name},
      {"against", arguments.plan.against},
      {"sweeps", arguments.plan.sweeps},
      {"copies", arguments.plan.copies},
      {"dt_fs", scene.run.dt_fs},
      {"method",
       {{"name", "baumgarte"},
        {"gains", c.method.gains},
        {"damping", c.method.damping},
        {"reduction", c.method.reduction}}},
      {"run", run_line(arguments, c)},
  };
  for (const auto& [name, value] : figures_of(c)) json[name] = value;
  json["disagreement"] = disagreement(arguments.plan, c);
  for (const ShapeCourse& shape : c.shapes)
    json["shapes"].push_back(
        {{"name", shape.name}, {"foretold", shape.foretold}, {"measured", shape.measured}});
  const std::string text = json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  if (json_alone()) return write_out(text);
  AtomicFile file(*arguments.json);
  file.write(text);
  file.commit();
}

}  // namespace

void add_calibrate(Commands& commands) {
  auto arguments = std::make_shared<CalibrateArguments>();
  const Subcommand command =
      commands.add("calibrate", "find the gains with which Baumgarte reduces errors as RATTLE does",
                   [arguments] { calibrate_scene(*arguments); });
  arguments->scene.NamedScene::offer(command);
  command.option("--against", arguments->plan.against, "rattle, shake or newton");
  const Argument tolerance = command.option("--tolerance", arguments->plan.tolerance, "of that method");
  command
      .option("--sweeps", arguments->plan.sweeps, "that method takes just so many, in place of a tolerance")
      .excludes(tolerance);
  command.option("--copies", arguments->plan.copies,
                 "mean, first or slowest: what of an error's course gains copy where steps are not alike");
  command.option("--damping", arguments->plan.damping, "discrete, centred, implicit or lagged");
  arguments->scene.offer_settings(command);
  command.option("--json", arguments->json, "write the figures there; -: print them alone");
  command.flag("--overwrite", arguments->overwrite, "though there is such a file");
}

}  // namespace taut
