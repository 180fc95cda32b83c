#include "studies/compared_methods.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/errors.hpp"
#include "measures/csv.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut {
namespace {

constexpr long kTurns = 20;

struct Runner {
  ComparedMethod& method;
  std::unique_ptr<TrialRun> run = {};
  std::vector<double> ns = {};  // a bond and step, a turn each

  void act(const auto& what) {
    if (method.trial.failed()) return;
    try {
      what();
    } catch (const SimulationFailure& e) {
      method.trial.failure = in_few_words(e.what());
    } catch (const InputError& e) {
      method.trial.failure = "refused: " + in_few_words(e.what());
    }
  }
};

void run_in_turns(const Scene& scene, const TrialPlan& plan, std::vector<ComparedMethod>& compared) {
  std::vector<Runner> runners;
  for (ComparedMethod& method : compared) runners.push_back({method});
  for (Runner& runner : runners)
    runner.act([&] {
      runner.run = std::make_unique<TrialRun>(scene, setting_of(runner.method.method), plan);
      runner.run->advance(plan.start);
    });
  for (long turn = 0; turn < kTurns; ++turn)
    for (Runner& runner : runners)
      runner.act([&] {
        runner.run->advance(plan.steps / kTurns);
        runner.ns.push_back(1000 * runner.run->trial().constraint_us / scene.system.bond_count());
      });
  for (Runner& runner : runners) {
    const std::string failure = runner.method.trial.failure;
    if (runner.run) runner.method.trial = runner.run->trial(), runner.method.doubts = runner.run->doubts();
    runner.method.trial.failure = failure;
    runner.method.ns_per_bond = quartiles(std::move(runner.ns));
  }
}

std::string figures_in_words(const ComparedMethod& of) {
  const Trial& t = of.trial;
  return fmt::format(
      "bonds right to {:.1e} rms, drift {} kJ/mol/ns per degree of freedom, {:.3g} ns a bond and step",
      t.rms_error.value, in_two_digits({t.drift, t.drift_error}), of.ns_per_bond.median);
}

std::string why_not(const ComparedMethod& of) {
  const Trial& t = of.trial;
  if (t.failed()) return t.failure;
  if (!t.keeps_energy() && t.may_keep_energy())
    return fmt::format(
        "its drift is known to ±{:.1g} kJ/mol/ns per degree of freedom alone: give --steps more",
        2 * t.drift_error);
  if (!t.keeps_energy())
    return fmt::format("it {} by {} kJ/mol/ns per degree of freedom", t.drift > 0 ? "heats" : "cools",
                       in_two_digits({std::abs(t.drift), t.drift_error}));
  if (!of.doubts.empty()) return of.doubts.front();
  if (!t.at_rest())
    return fmt::format("its bond error is not at rest: its later half has {:.2g} times that of the earlier",
                       t.later_over_earlier);
  return "its constraints heat or cool";
}

}  // namespace

bool ComparedMethod::sound() const {
  const Estimate& bonds = trial.constraint_drift;
  return !trial.failed() && doubts.empty() && trial.at_rest() && trial.keeps_energy() &&
         std::abs(bonds.value) <= 0.1 * trial.kT + 3 * std::max(bonds.error, trial.drift_error);
}

std::vector<std::string> take_out_common_doubts(std::vector<ComparedMethod>& compared) {
  const auto words = [](const std::string& doubt) {
    return doubt.substr(0, doubt.find_first_of("0123456789"));
  };
  const std::vector<std::string> common =
      std::ranges::find(compared, "newton", &ComparedMethod::method)->doubts;
  for (ComparedMethod& each : compared)
    std::erase_if(each.doubts, [&](const std::string& doubt) {
      return std::ranges::any_of(common,
                                 [&](const std::string& other) { return words(other) == words(doubt); });
    });
  return common;
}

std::vector<ComparedMethod> compare_methods(const Scene& scene, const CalibrationPlan& plan,
                                            const Calibration& c) {
  std::vector<ComparedMethod> compared;
  const auto add = [&](const std::string& method, const char* role) {
    if (std::ranges::find(compared, method, &ComparedMethod::method) == compared.end())
      compared.push_back({method, role, {}, {}, {}, {}});
  };
  add(c.reference_method, "the reference"), add(method_of(c), "as calibrated");
  add("baumgarte", "its default"), add("newton", "the default method");
  for (ComparedMethod& method : compared) {
    if (method.method == c.reference_method)
      method.reduction = {std::nan(""), c.reduction_reference};
    else if (method.method == method_of(c))
      method.reduction = c.of_stretch;
    else
      Runner{method}.act(
          [&] { method.reduction = reduction_of(scene, method_in_word(method.method), plan); });
  }
  const long steps = std::max(1L, plan.compared_steps / kTurns) * kTurns;
  run_in_turns(
      scene,
      {.start = std::max(1L, steps / 4), .steps = steps, .rows = std::min(steps, std::max(400L, steps / 10))},
      compared);
  return compared;
}

const ComparedMethod* best_of(const std::vector<ComparedMethod>& compared) {
  const ComparedMethod* cheapest = nullptr;
  for (const ComparedMethod& each : compared)
    if (each.sound() && (!cheapest || each.ns_per_bond.median < cheapest->ns_per_bond.median))
      cheapest = &each;
  if (!cheapest) return nullptr;
  const auto as_cheap = [&](const ComparedMethod& each) {
    return each.sound() && each.ns_per_bond.low <= cheapest->ns_per_bond.high;
  };
  for (const ComparedMethod& each : compared)
    if (each.role == "as calibrated" && as_cheap(each)) return &each;
  return &*std::ranges::find_if(compared, as_cheap);
}

std::string verdict_of(const std::vector<ComparedMethod>& compared, double step_fs) {
  const ComparedMethod *best = best_of(compared), &reference = compared.front();
  const std::string at = fmt::format("at {:g} fs", step_fs);
  if (!best) {
    std::vector<std::string> reasons;
    for (const ComparedMethod& each : compared) reasons.push_back(each.method + ": " + why_not(each));
    return fmt::format("take a shorter step: {} no method here is sound ({})", at, fmt::join(reasons, "; "));
  }
  std::string text = fmt::format("take {}, {}: {} {}", best->method, best->role, at, figures_in_words(*best));
  if (best == &reference) return text + "; no other that is sound is cheaper";
  text += fmt::format("; {} has ", reference.method);
  text += reference.trial.failed() ? "failed: " + reference.trial.failure : figures_in_words(reference);
  if (!reference.sound() && !reference.trial.failed()) text += ", and is not sound: " + why_not(reference);
  const auto newton = std::ranges::find(compared, "newton", &ComparedMethod::method);
  if (newton != compared.end() && newton != compared.begin() && best != &*newton && newton->sound())
    text += fmt::format("; newton has bonds right to {:.1e} rms, {:.3g} ns", newton->trial.rms_error.value,
                        newton->ns_per_bond.median);
  for (const ComparedMethod& each : compared)
    if (each.role == "as calibrated" && !each.sound())
      text += fmt::format("; the calibrated {} is not sound: {}", each.method, why_not(each));
  return text;
}

std::string compared_csv(const std::vector<ComparedMethod>& compared) {
  std::string text =
      "method,role,reduction_predicted,reduction_measured,rms_rel_bond_error,rms_rel_bond_error_se,"
      "max_rel_bond_error,bond_error_slope_per_ns,bond_error_slope_se,drift_kj_mol_ns_dof,drift_se,"
      "constraint_drift_kj_mol_ns_dof,constraint_drift_se,ns_per_bond_step,sound,take,failure\n";
  const ComparedMethod* best = best_of(compared);
  for (const ComparedMethod& each : compared) {
    const Trial& t = each.trial;
    const auto number = [](double x) { return std::isfinite(x) ? fmt::format("{:.6e}", x) : ""; };
    const double figures[] = {each.reduction.predicted,
                              each.reduction.measured,
                              t.rms_error.value,
                              t.rms_error.error,
                              t.max_error,
                              t.error_slope.value,
                              t.error_slope.error,
                              t.drift,
                              t.drift_error,
                              t.constraint_drift.value,
                              t.constraint_drift.error,
                              each.ns_per_bond.median};
    text += fmt::format("{},{}", csv_cell(each.method), each.role);
    for (const double figure : figures) text += "," + (t.failed() ? "" : number(figure));
    text += fmt::format(",{:d},{:d},{}\n", each.sound(), &each == best, csv_cell(t.failure));
  }
  return text;
}

}  // namespace taut
