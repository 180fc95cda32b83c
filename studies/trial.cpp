#include "studies/trial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>

#include "base/errors.hpp"
#include "base/exceeds.hpp"
#include "base/series.hpp"
#include "systems/scene/scene_file.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {
namespace {

// Where all is at rest, energies are kept to this share of themselves.
constexpr double kAtRest = 1e-6;

// A curve's points: values of one setting of the method, from cheap to exact; a few of them where it must be quick.
struct CurveValues {
  const char* parameter;
  std::vector<const char*> all, few;
};
const std::vector<CurveValues>& curves() {
  static const std::vector<CurveValues> kCurves = {
      {"tolerance", {"1e-3", "1e-4", "1e-5", "1e-6", "1e-8", "1e-10", "1e-12"}, {"1e-4", "1e-6", "1e-8"}},
      {"sweeps", {"1", "2", "4", "8", "16"}, {"1", "4"}},
      {"order", {"1", "2", "4", "6", "8", "12"}, {"2", "4", "8"}},
      {"iterations", {"1", "2", "4"}, {"1", "2"}},
      {"gains", {"critical", "box2d", "dead-beat", "reversible"}, {"dead-beat", "reversible"}},
      {"extrapolation", {"0", "1", "2"}, {"0", "1", "2"}},
      {"omega_h", {"0.2", "0.4", "0.7", "1.2"}, {"0.4", "0.7"}}};
  return kCurves;
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

Setting setting_of(const std::string& method) {
  return {method, "", "", overrides_of_method(method)};
}

std::vector<Setting> settings_of(const std::string& method, double h, bool few) {
  if (method.find(':') != method.npos) return {setting_of(method)};
  std::vector<Setting> settings;
  for (const auto& [parameter, all_values, few_values] : curves())
    if (has_key(method, parameter))
      for (const char* value : few ? few_values : all_values)
        settings.push_back(setting(method, parameter, value, h));
  if (settings.empty()) settings.push_back(setting_of(method));
  return settings;
}

std::string in_two_digits(const Estimate& estimate) {
  const auto& [value, error] = estimate;
  if (!(error > 0)) return fmt::format("{:.2g}", value);
  const int digits = 1 - static_cast<int>(std::floor(std::log10(error)));
  if (digits < 0 || digits > 4) return fmt::format("{:.1e} ± {:.0e}", value, error);
  return fmt::format("{:.{}f} ± {:.{}f}", value, digits, error, digits);
}

std::string in_few_words(const std::string& failure) {
  std::string line = failure.substr(0, failure.find('\n'));
  if (line.starts_with("step ")) {
    if (const auto colon = line.find(": "); colon != line.npos) line = line.substr(colon + 2);
  }
  for (const char* aside : {" (a triangle", ";"}) line = line.substr(0, line.find(aside));
  return line;
}

bool Trial::at_rest() const {
  const auto& [slope, error] = error_slope;
  return std::abs(later_over_earlier - 1) <= 0.1 || std::abs(slope) <= 4 * error;
}

bool Trial::may_keep_energy() const {
  return std::abs(drift) <= 0.1 * kT + 3 * drift_error;
}

bool Trial::keeps_energy() const {
  const bool known = drift_error > 0 || drift == 0;  // too few rows tell no error
  return known && may_keep_energy() && std::abs(drift) + 2 * drift_error <= kT;
}

namespace {

// A scene that runs until it is told how far.
Scene ready(Scene scene, const Setting& setting, const TrialPlan& plan) {
  scene.run.steps = plan.start + plan.steps;
  apply_overrides(scene, setting.overrides);
  scene.run.log_every = std::max(1L, plan.steps / plan.rows);
  return scene;
}

// √ of a mean of squares.
Estimate root(const Estimate& square) {
  const double value = std::sqrt(square.value);
  return {value, value > 0 ? square.error / (2 * value) : 0.0};
}

}  // namespace

TrialRun::TrialRun(Scene scene, const Setting& setting, const TrialPlan& plan)
    : plan_(plan), simulation_(ready(std::move(scene), setting, plan)) {}

void TrialRun::advance(long steps) {
  RunSettings run = simulation_.scene().run;
  run.steps = simulation_.step() + steps;
  simulation_.change(run);
  const Summary summary = simulation_.run([this](const Record& r) { watch(r); });
  constraint_us_ = summary.constraint_us_per_step;
  step_us_ = summary.us_per_step;
  doubts_ = summary.doubts;
}

void TrialRun::watch(const Record& r) {
  const long since = t_.empty() ? simulation_.scene().run.log_every : r.step - last_row_;
  last_row_ = r.step;
  if (rows_++ == 0) first_energy_ = r.but_for_heat();
  largest_kinetic_ = std::max(largest_kinetic_, r.kinetic);
  const double energy = std::max(largest_kinetic_, kAtRest * std::abs(first_energy_));
  if (exceeds(std::abs(r.but_for_heat() - first_energy_), plan_.broken_energy * energy) && energy > 0)
    throw SimulationFailure("the energy blew up");
  if (exceeds(r.bonds.max, plan_.broken_bond))
    throw SimulationFailure(fmt::format("bonds {:g} % off", 100 * plan_.broken_bond));
  if (r.step < plan_.start) return;
  t_.push_back(r.t);
  squares_.push_back(r.bonds.rms * r.bonds.rms);
  largest_.push_back(r.bonds.max);
  kinetic_sum_ += r.kinetic;
  energy_.add(r.t, r.but_for_heat(), since);
  constraint_work_.add(r.t, r.constraint_work, since);
}

Trial TrialRun::trial() const {
  Trial trial{.steps = last_row_, .constraint_us = constraint_us_, .step_us = step_us_};
  if (t_.empty()) return trial;
  const std::span<const double> squares = squares_;
  const std::size_t half = squares.size() / 2;
  trial.rms_error = root(correlated_mean(squares));
  const auto mean = [](std::span<const double> part) {
    return std::reduce(part.begin(), part.end()) / static_cast<double>(part.size());
  };
  trial.max_error = mean(largest_);
  if (const double earlier = half > 0 ? mean(squares.first(half)) : 0; earlier > 0)
    trial.later_over_earlier = std::sqrt(mean(squares.subspan(half)) / earlier);
  std::vector<double> rms;
  for (const double square : squares) rms.push_back(std::sqrt(square));
  trial.error_slope = block_slope(t_, rms);
  trial.error_slope.value *= 1000, trial.error_slope.error *= 1000;
  const double per_ns_dof = 1000.0 / std::max(1, simulation_.dof().total());
  const Estimate drift = energy_.estimate(), of_bonds = constraint_work_.estimate();
  trial.drift = drift.value * per_ns_dof;
  trial.constraint_drift = {of_bonds.value * per_ns_dof, of_bonds.error * per_ns_dof};
  trial.kT = 2 * kinetic_sum_ / static_cast<double>(t_.size()) / std::max(1, simulation_.dof().total());
  if (std::ssize(t_) >= kRowsForInterval) trial.drift_error = drift.error * per_ns_dof;
  return trial;
}

Trial try_setting(Scene scene, const Setting& setting, const TrialPlan& plan, State& end) {
  std::optional<TrialRun> run;
  std::string failure;
  try {
    run.emplace(std::move(scene), setting, plan);
    if (plan.start > 0) run->advance(plan.start);
    run->advance(plan.steps);
    end = run->simulation().state();
  } catch (const SimulationFailure& e) {
    failure = in_few_words(e.what());
  } catch (const InputError& e) {
    failure = "refused: " + in_few_words(e.what());
  }
  Trial trial = run ? run->trial() : Trial();
  trial.failure = failure;
  return trial;
}

Trial try_setting(Scene scene, const Setting& setting, const TrialPlan& plan) {
  State ignored;
  return try_setting(std::move(scene), setting, plan, ignored);
}

}  // namespace taut
