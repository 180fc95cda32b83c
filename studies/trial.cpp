#include "studies/trial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/exceeds.hpp"
#include "simulation/simulation.hpp"
#include "systems/scene_file.hpp"

namespace taut {
namespace {

// Where all is at rest, energies are kept to this share of themselves.
constexpr double kAtRest = 1e-6;

// What a curve may go through, in the order in which a reader walks it: from cheap to exact.
struct Sweep {
  const char* parameter;
  std::vector<const char*> all, few;
};
const std::vector<Sweep>& sweeps() {
  static const std::vector<Sweep> kSweeps = {
      {"tolerance", {"1e-3", "1e-4", "1e-5", "1e-6", "1e-8", "1e-10", "1e-12"}, {"1e-4", "1e-6", "1e-8"}},
      {"sweeps", {"1", "2", "4", "8", "16"}, {"1", "4"}},
      {"order", {"1", "2", "4", "6", "8", "12"}, {"2", "4", "8"}},
      {"iterations", {"1", "2", "4"}, {"1", "2"}},
      {"gains", {"critical", "box2d", "dead-beat", "reversible"}, {"dead-beat", "reversible"}},
      {"extrapolation", {"0", "1", "2"}, {"0", "1", "2"}},
      {"omega_h", {"0.2", "0.4", "0.7", "1.2"}, {"0.4", "0.7"}}};
  return kSweeps;
}

bool has_key(const std::string& method, std::string_view parameter) {
  MethodOptions options = default_options(method);
  return std::ranges::any_of(options.describe(),
                             [&](const Option& option) { return option.key == parameter; });
}

Setting setting(const std::string& method, const std::string& parameter, const std::string& value, double h) {
  Setting s{method, parameter, value, {"method.name=" + method, "method." + parameter + "=" + value}};
  if (method == "baumgarte" &&
      parameter == "sweeps") {  // αh = 1, βh = ½: what one sweep bears (README there)
    s.overrides.emplace_back("method.gains=numbers");
    s.overrides.push_back(fmt::format("method.alpha_per_ps={:.17g}", 1 / h));
    s.overrides.push_back(fmt::format("method.beta_per_ps={:.17g}", 0.5 / h));
  } else if (parameter == "iterations") {
    s.overrides.emplace_back("method.order=8");
  }
  return s;
}

}  // namespace

std::vector<Setting> settings_of(const std::string& method, double h, bool few) {
  std::vector<Setting> settings;
  for (const Sweep& sweep : sweeps())
    if (has_key(method, sweep.parameter))
      for (const char* value : few ? sweep.few : sweep.all)
        settings.push_back(setting(method, sweep.parameter, value, h));
  if (settings.empty()) settings.push_back({method, "", "", {"method.name=" + method}});
  return settings;
}

std::string in_few_words(const std::string& failure) {
  std::string line = failure.substr(0, failure.find('\n'));
  if (line.starts_with("step ")) {
    if (const auto colon = line.find(": "); colon != line.npos) line = line.substr(colon + 2);
  }
  for (const char* aside : {" (a triangle", ";"}) line = line.substr(0, line.find(aside));
  return line;
}

Trial try_setting(Scene scene, const Setting& setting, const TrialPlan& plan, State& end) {
  Trial trial;
  int rows = 0;
  double first_energy = 0, largest_kinetic = 0, squares = 0;
  const auto watch = [&](const Record& r) {
    trial.steps = r.step;
    if (exceeds(r.bonds.max, trial.max_error)) trial.max_error = r.bonds.max;
    squares += r.bonds.rms * r.bonds.rms;
    if (rows++ == 0) first_energy = r.total();
    largest_kinetic = std::max(largest_kinetic, r.kinetic);
    trial.rms_error = std::sqrt(squares / rows);
    const double energy = std::max(largest_kinetic, kAtRest * std::abs(first_energy));
    if (exceeds(std::abs(r.total() - first_energy), plan.broken_energy * energy) && energy > 0)
      throw SimulationFailure("the energy blew up");
    if (exceeds(r.bonds.max, plan.broken_bond))
      throw SimulationFailure(fmt::format("bonds {:g} % off", 100 * plan.broken_bond));
  };
  try {
    apply_overrides(scene, setting.overrides);
    scene.run.steps = plan.steps;
    scene.run.log_every = std::max(1L, plan.steps / plan.rows);
    Simulation simulation(std::move(scene), available_threads(), plan.listen);
    const Summary summary = simulation.run(watch, at_steps(plan.listen));
    trial.constraint_us = summary.constraint_us_per_step;
    trial.step_us = summary.us_per_step;
    trial.drift = summary.drift.value;
    trial.constraint_drift = summary.constraint_drift.value;
    if (rows >= kRowsForInterval) trial.drift_error = summary.drift.error;
    end = simulation.state();
  } catch (const SimulationFailure& e) {
    trial.failure = in_few_words(e.what());
  } catch (const InputError& e) {
    trial.failure = "refused: " + in_few_words(e.what());
  }
  return trial;
}

Trial try_setting(Scene scene, const Setting& setting, const TrialPlan& plan) {
  State ignored;
  return try_setting(std::move(scene), setting, plan, ignored);
}

}  // namespace taut
