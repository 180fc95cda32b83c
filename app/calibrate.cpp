#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/words.hpp"
#include "command_line.hpp"
#include "commands.hpp"
#include "files/atomic_file.hpp"
#include "printing.hpp"
#include "scene_argument.hpp"
#include "studies/compared_methods.hpp"
#include "studies/openmm_twin.hpp"
#include "studies/study_scene.hpp"
#include "study.hpp"

namespace taut {
namespace {

struct CalibrateArguments {
  SceneArgument scene;
  CalibrationPlan plan;
  std::optional<std::filesystem::path> json;
  bool overwrite = false;
};

constexpr int kPage = 100;

void print_course(const std::string& name, const std::vector<double>& values) {
  say("  {:<24}", name);
  for (std::size_t n = 0; n < std::min<std::size_t>(values.size(), 7); ++n) say(" {:>8.1e}", values[n]);
  say("\n");
}

// Prints the error that so many sweeps leave in theory, and the measured one, of each kind of cluster.
void print_shapes(const Calibration& c) {
  constexpr long kMost = 6;
  for (std::size_t n = 0; n < std::min<std::size_t>(c.shapes.size(), kMost); ++n) {
    say("  {} in {}\n", c.reference_method, c.shapes[n].name);
    print_course("  in theory", c.shapes[n].foretold);
    print_course("  measured", c.shapes[n].measured);
  }
  if (std::ssize(c.shapes) > kMost)
    say("  and {} more of clusters (--json has all)\n", counted(std::ssize(c.shapes) - kMost, "kind"));
}

// Returns the command that runs the scene with a method, or sets it beside OpenMM.
std::string run_line(const CalibrateArguments& arguments, const std::string& method,
                     const char* command = "run") {
  CommandLine line = arguments.scene.line(command);
  line.option(command == std::string_view("run") ? "--method" : "--methods", std::vector{method});
  line.option("--dt-fs", arguments.scene.dt_fs);
  line.option("--set", arguments.scene.settings);
  return line.text();
}

void print_compared(const std::vector<ComparedMethod>& compared) {
  constexpr auto kRow = "{:<24} {:>10} {:>9} {:>8} {:>8} {:>17} {:>14} {:>14} {:>6}\n";
  say("\n");
  say(kRow, "", "error left", "a step", "bond", "error", "its slope", "energy drift", "bonds' share", "ns a");
  say(kRow, "", "predicted", "measured", "rms", "largest", "[1/ns]", "[kJ/mol/ns/", "dof]", "bond");
  for (const ComparedMethod& each : compared) {
    const Trial& t = each.trial;
    const auto& [predicted, measured] = each.reduction;
    const bool calibrated = each.role == "as calibrated";
    const std::string name = calibrated ? "baumgarte, as calibrated" : each.method;
    if (t.failed()) {
      say("{:<24} failed: {}\n", name, t.failure);
      continue;
    }
    say(kRow, name, std::isfinite(predicted) ? fmt::format("{:.4g}", predicted) : "–",
        fmt::format("{:.4g}", measured), fmt::format("{:.1e}", t.rms_error.value),
        fmt::format("{:.1e}", t.max_error), in_two_digits(t.error_slope),
        in_two_digits({t.drift, t.drift_error}), in_two_digits(t.constraint_drift),
        fmt::format("{:.3g}", each.ns_per_bond.median));
  }
}

void print(const Scene& scene, const CalibrateArguments& arguments, const Calibration& c,
           const std::vector<ComparedMethod>& compared, const std::vector<std::string>& common_doubts) {
  const CalibrationPlan& plan = arguments.plan;
  const double h = scene.run.h();
  say("{}: {}, h = {:g} fs, seed {}\n", scene.name, counted(scene.system.bond_count(), "bond"),
      scene.run.dt_fs, scene.run.seed);
  print_notes(scene.notes);
  std::string taken;
  if (!compared.empty()) {
    for (const std::string& doubt : common_doubts)
      say("\n{}\n", wrapped("in doubt with every method: " + doubt, kPage, 2));
    say("\n{}\n", wrapped(verdict_of(compared, scene.run.dt_fs), kPage, 2));
    if (const ComparedMethod* best = best_of(compared)) {
      taken = best->method;
      say("  {}\n", run_line(arguments, taken));
      if (built_with_openmm()) say("  {}\n", run_line(arguments, taken, "crosscheck"));
    }
    print_compared(compared);
    say("\n{}\n",
        wrapped(
            fmt::format("Runs of {} steps in turns, a quarter of them more before; ± is a standard error. "
                        "Bond errors are relative, the largest that of a step's worst bond, on average. "
                        "kT is {:.3g} kJ/mol.",
                        plan.compared_steps, compared.front().trial.kT),
            kPage, 0));
  }
  say("\n{}\n",
      wrapped(
          fmt::format(
              "Why: {} leaves {:.4g} of an error of the bond lengths a step{}. Baumgarte's law leaves as "
              "much, from the step after on, with alpha_per_ps = {:.6g}, beta_per_ps = {:.6g} (αh = {:.4g}, "
              "βh = {:.4g}), which is {}.{}",
              c.reference_method, c.reduction_reference,
              plan.copies == "slowest" ? ", where its sweeps leave most"
              : plan.copies == "first" ? ", in its first"
                                       : fmt::format(", on average over {}", counted(c.window, "step")),
              c.alpha_per_ps, c.beta_per_ps, c.alpha_per_ps * h, c.beta_per_ps * h, method_of(c),
              c.reduction_reference < 1e-6
                  ? " So little is left that these gains are next to dead-beat, which leaves nothing."
                  : ""),
          kPage, 0));
  if (taken != method_of(c)) say("  {}\n", run_line(arguments, method_of(c)));
  say("\nan error of {:g} put on every bond, and what is left of it beside a run without: rms of ½(r² − "
      "d²)/d²\n  {:<24}",
      plan.size, "steps later");
  for (int n = 0; n < 7; ++n) say(" {:>8}", n);
  say("\n");
  print_course(c.reference_method, c.reference.stretch);
  print_course("baumgarte, as calibrated", c.baumgarte.stretch);
  print_course("  predicted", c.foretold);
  print_shapes(c);
  say("\n{:46} {:>10} {:>10}\n", "baumgarte, as calibrated", "predicted", "measured");
  const auto row = [](const char* what, double predicted, double measured) {
    say("{:46} {:>10.4g} {:>10.4g}\n", what, predicted, measured);
  };
  row("left a step of an error of the lengths", c.of_stretch.predicted, c.of_stretch.measured);
  row("… of the rate at which that goes", c.of_rate.predicted, c.of_rate.measured);
  row("… of what an error of velocities makes of them", c.after_rate.predicted, c.after_rate.measured);
  row("error with nothing put in, rms", c.floor_predicted, c.floor_measured);
  if (const std::string why = disagreement(plan, c); !why.empty()) say("\n{}\n", wrapped(why, kPage, 2));
}

void calibrate_scene(const CalibrateArguments& arguments) {
  refuse_without_effect("calibrate", arguments.scene.overrides());
  if (arguments.json && arguments.json != "-") expect_no_file({*arguments.json}, arguments.overwrite);
  if (arguments.json == "-") print_json_alone();
  const Scene scene = prepared_for_study(arguments.scene.read());
  const Calibration c = calibrate(scene, arguments.plan);
  std::vector<ComparedMethod> compared;
  std::vector<std::string> common_doubts;
  if (arguments.plan.compared_steps > 0) {
    compared = compare_methods(scene, arguments.plan, c);
    common_doubts = take_out_common_doubts(compared);
  }
  print(scene, arguments, c, compared, common_doubts);
  if (!arguments.json) return;
  nlohmann::ordered_json json = {
      {"scene", scene.name},
      {"against", c.reference_method},
      {"sweeps", c.sweeps},
      {"copies", arguments.plan.copies},
      {"dt_fs", scene.run.dt_fs},
      {"method",
       {{"name", "baumgarte"},
        {"gains", c.method.gains},
        {"damping", c.method.damping},
        {"reduction", *c.method.reduction}}},
      {"run", run_line(arguments, method_of(c))},
  };
  if (!compared.empty()) {
    json["table"] = json_of_csv(compared_csv(compared));
    json["in_doubt_with_every_method"] = common_doubts;
    json["verdict"] = verdict_of(compared, scene.run.dt_fs);
    if (const ComparedMethod* best = best_of(compared)) json["take"] = run_line(arguments, best->method);
  }
  for (const auto& [name, value] : figures_of(c)) json[name] = value;
  json["disagreement"] = disagreement(arguments.plan, c);
  for (const ShapeCourse& shape : c.shapes)
    json["shapes"].push_back(
        {{"name", shape.name}, {"foretold", shape.foretold}, {"measured", shape.measured}});
  if (json_alone()) return write_json(json);
  write_file(*arguments.json, json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace

void add_calibrate(Commands& commands) {
  auto arguments = std::make_shared<CalibrateArguments>();
  const Subcommand command =
      commands.add("calibrate", "find the gains with which Baumgarte reduces errors as RATTLE does",
                   [arguments] { calibrate_scene(*arguments); });
  arguments->scene.NamedScene::offer(command);
  command.option("--against", arguments->plan.against,
                 "rattle, shake or newton, with settings as in rattle:tolerance=1e-6");
  command.option("--sweeps", arguments->plan.sweeps, "that method takes just so many, as in rattle:sweeps=4");
  command.option("--copies", arguments->plan.copies,
                 "mean, first or slowest: what of an error's course gains copy where steps are not alike");
  command.option("--steps", arguments->plan.compared_steps, "of the runs that compare the methods; 0: none");
  command.option("--damping", arguments->plan.damping, "discrete, centred, implicit or lagged");
  arguments->scene.offer_settings(command);
  command.option("--json", arguments->json, "write the figures there; -: print them alone");
  command.flag("--overwrite", arguments->overwrite, "though there is such a file");
}

}  // namespace taut
