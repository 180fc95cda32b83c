#include "studies/chart_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/statistics.hpp"
#include "md/observables.hpp"
#include "measures/csv.hpp"
#include "studies/repeats.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut {
namespace {

constexpr long kTimedStart = 40;  // of a timed run: the longest memory that a default has is gone by then

// Constraint time a bond and step [ns].
Quartiles cost(const std::string& point, int repeats, int bonds, const Ledger& ledger) {
  const double each = 1000.0 / std::max(1, bonds);
  const Quartiles us = over_repeats(point, repeats, ledger, &Trial::constraint_us);
  return {us.low * each, us.median * each, us.high * each};
}

std::string columns(const Setting& s) {
  return fmt::format("{},{},{},{}", csv_cell(s.curve()), csv_cell(s.method), s.parameter, s.value);
}

std::string work_name(const Setting& s) {
  return "work/" + s.name();
}
std::string drift_name(const Setting& s) {
  return "drift/" + s.name();
}

// ---- order

std::vector<int> divisors(const ChartPlan& plan) {
  return plan.quick ? std::vector{1, 2, 4} : std::vector{1, 2, 4, 8, 16};
}

std::string order_name(const std::string& method, int divisor) {
  return fmt::format("order/{}/h0 over {}", method, divisor);
}

// Held so tightly that a curve shows its method's order, not where iterations were stopped.
Setting held_to(const char* tolerance, const std::string& method) {
  Setting s = setting_of(method);
  if (method == "newton" || method == "rattle" || method == "shake")
    s.overrides.push_back(std::string("method.tolerance=") + tolerance);
  return s;
}

double rms_distance(const Vectors& a, const Vectors& b) {
  return std::sqrt((a - b).squaredNorm() / static_cast<double>(a.cols()));
}

// The reference is run once, by whoever asks first.
struct Reference {
  Scene scene;
  int divisor;
  std::optional<Vectors> x = {};

  std::string method() const { return std::string(usual_method(scene.system)); }
  const Vectors& positions() {
    if (x) return *x;
    Scene fine = scene;
    fine.run.dt_fs /= divisor;
    State end;
    const Trial trial =
        try_setting(fine, held_to("1e-12", method()), {.steps = kOrderSteps * divisor, .rows = 1}, end);
    x = trial.failed() ? Vectors() : end.x;
    return *x;
  }
};

Trial compared(const ChartPlan& plan, const std::string& method, int divisor, Reference& reference) {
  Scene scene = plan.scene;
  scene.run.dt_fs /= divisor;
  State end;
  const long half = kOrderSteps / 2 * divisor;
  Trial trial =
      try_setting(scene, held_to("1e-11", method), {.start = half, .steps = half, .rows = half}, end);
  if (trial.failed()) return trial;
  const Vectors& x = reference.positions();
  if (x.cols() == end.x.cols())
    trial.figure = rms_distance(end.x, x);
  else
    trial.failure =
        fmt::format("no reference to compare with: {} failed at the fine step", reference.method());
  return trial;
}

// ---- length

std::vector<int> lengths(const ChartPlan& plan) {
  return plan.quick ? std::vector{10, 100, 1000} : std::vector{10, 30, 100, 300, 1000, 3000, 10000};
}

std::string length_name(const std::string& method, int bonds) {
  return fmt::format("length/{}/{}", method, bonds);
}

int copies(const ChartPlan& plan, int bonds) {
  return std::max(1, (plan.quick ? 1000 : 10000) / bonds);
}

Trial run_length(const ChartPlan& plan, const std::string& method, int bonds) {
  const Scene chains = read_scene(
      find_scene("freely_jointed"),
      {fmt::format("build.chains={}", copies(plan, bonds)), fmt::format("build.beads={}", bonds + 1)});
  return try_setting(chains, held_to("1e-8", method),
                     {.start = kTimedStart, .steps = plan.quick ? 20 : 100, .rows = 4});
}

}  // namespace

void ChartPlan::make_quick() {
  quick = true;
  repeats = 2;
  steps = 20;
  drift_steps = 300;
}

std::vector<Setting> ChartPlan::settings() const {
  std::vector<Setting> all;
  for (const auto& method : methods)
    for (const auto& setting : settings_of(method, scene.run.h(), quick)) all.push_back(setting);
  return all;
}

bool ChartPlan::has(std::string_view panel) const {
  if (panel == "work" && panels.contains("drift")) return true;
  return panels.contains(panel) && (panel != "precision" || has_precisions(scene));
}

std::vector<Job> work_jobs(const ChartPlan& plan, const Ledger& ledger) {
  std::vector<Job> points, runs;
  for (const Setting& s : plan.settings()) {
    points.push_back({work_name(s), [&plan, s] {
                        return try_setting(plan.scene, s,
                                           {.start = kTimedStart, .steps = plan.steps, .rows = 2});
                      }});
    runs.push_back({drift_name(s), [&plan, s] { return try_setting(plan.scene, s, plan.long_trial()); }});
  }
  std::vector<Job> jobs = interleaved(points, plan.repeats, ledger);
  jobs.insert(jobs.end(), runs.begin(), runs.end());
  return jobs;
}

std::vector<Job> order_jobs(const ChartPlan& plan) {
  const auto reference = std::make_shared<Reference>(Reference{plan.scene, 4 * divisors(plan).back()});
  std::vector<Job> jobs;
  for (const auto& method : plan.methods)
    for (const int divisor : divisors(plan))
      jobs.push_back({order_name(method, divisor), [&plan, method, divisor, reference] {
                        return compared(plan, method, divisor, *reference);
                      }});
  return jobs;
}

std::vector<Job> length_jobs(const ChartPlan& plan, const Ledger& ledger) {
  std::vector<Job> points;
  for (const auto& method : plan.methods)
    for (const int bonds : lengths(plan))
      points.push_back(
          {length_name(method, bonds), [&plan, method, bonds] { return run_length(plan, method, bonds); }});
  return interleaved(points, plan.repeats, ledger);
}

std::vector<Job> chart_jobs(const ChartPlan& plan, const Ledger& ledger) {
  std::vector<Job> jobs;
  const auto add = [&](const char* panel, const std::vector<Job>& its) {
    if (plan.has(panel)) jobs.insert(jobs.end(), its.begin(), its.end());
  };
  add("work", work_jobs(plan, ledger)), add("order", order_jobs(plan));
  add("length", length_jobs(plan, ledger)), add("precision", precision_jobs(plan, ledger));
  return jobs;
}

std::vector<std::pair<std::string, std::string>> chart_tables(const ChartPlan& plan, const Ledger& ledger) {
  std::vector<std::pair<std::string, std::string>> tables;
  const auto add = [&](const char* panel, std::string (*csv)(const ChartPlan&, const Ledger&)) {
    if (plan.has(panel)) tables.emplace_back(panel, csv(plan, ledger));
  };
  add("work", work_csv), add("drift", drift_csv), add("order", order_csv);
  add("length", length_csv), add("precision", precision_csv);
  tables.emplace_back("failures", failures_csv(plan, ledger));
  return tables;
}

std::string work_csv(const ChartPlan& plan, const Ledger& ledger) {
  std::string text =
      "curve,method,parameter,value,rms_rel_bond_error,rms_low,rms_high,max_rel_bond_error,later_over_"
      "earlier,"
      "at_rest,ns_per_bond_step_q1,ns_per_bond_step,ns_per_bond_step_q3,step_us,repeats,failure\n";
  for (const Setting& s : plan.settings()) {
    const Trial &timed = ledger.at(repeat_name(work_name(s), 0)), &run = ledger.at(drift_name(s));
    const Quartiles ns = cost(work_name(s), plan.repeats, plan.scene.system.bond_count(), ledger);
    const auto& [rms, error] = run.rms_error;
    if (const std::string& failure = timed.failed() ? timed.failure : run.failure; !failure.empty())
      text += fmt::format("{},,,,,,,,,,,0,{}\n", columns(s), csv_cell(failure));
    else
      text += fmt::format("{},{:.6e},{:.6e},{:.6e},{:.6e},{:.4g},{:d},{:.4g},{:.4g},{:.4g},{:.4g},{},\n",
                          columns(s), rms, std::max(0.0, rms - 1.96 * error), rms + 1.96 * error,
                          run.max_error, run.later_over_earlier, run.at_rest(), ns.low, ns.median, ns.high,
                          timed.step_us, plan.repeats);
  }
  return text;
}

std::vector<std::string> not_at_rest(const ChartPlan& plan, const Ledger& ledger) {
  std::vector<std::string> found;
  for (const Setting& s : plan.settings())
    if (const Trial& run = ledger.at(drift_name(s)); !run.failed() && !run.at_rest())
      found.push_back(fmt::format("{} ({:.2g})", s.name(), run.later_over_earlier));
  return found;
}

std::string drift_csv(const ChartPlan& plan, const Ledger& ledger) {
  std::string text =
      "curve,method,parameter,value,ns_per_bond_step,drift_kj_mol_ns_dof,drift_low,drift_high,"
      "constraint_drift_kj_mol_ns_dof,steps,failure\n";
  for (const Setting& s : plan.settings()) {
    const Trial& t = ledger.at(drift_name(s));
    const Quartiles ns = cost(work_name(s), plan.repeats, plan.scene.system.bond_count(), ledger);
    text += t.failed()
                ? fmt::format("{},,,,,,{},{}\n", columns(s), t.steps, csv_cell(t.failure))
                : fmt::format("{},{:.4g},{:.6e},{:.6e},{:.6e},{:.6e},{},\n", columns(s), ns.median, t.drift,
                              t.drift_low(), t.drift_high(), t.constraint_drift.value, plan.drift_steps);
  }
  return text;
}

std::vector<ChartPoint> chart_points(const ChartPlan& plan, const Ledger& ledger) {
  std::vector<ChartPoint> points;
  for (const Setting& s : plan.settings()) {
    const Trial &work = ledger.at(repeat_name(work_name(s), 0)), &drift = ledger.at(drift_name(s));
    if (work.failed() || drift.failed()) continue;
    ChartPoint& point = points.emplace_back();
    point.method = s.method;
    point.name = s.parameter.empty() ? s.method : fmt::format("{} ({} {})", s.method, s.parameter, s.value);
    point.error = drift.rms_error.value;
    point.cost = cost(work_name(s), plan.repeats, plan.scene.system.bond_count(), ledger);
    if (drift.drift_error > 0) {
      point.keeps_energy = drift.drift_low() <= 0 && 0 <= drift.drift_high();
      point.width = drift.drift_high() - drift.drift;
    }
  }
  return points;
}

std::string order_csv(const ChartPlan& plan, const Ledger& ledger) {
  std::string text = "method,dt_fs,rms_distance_nm,rms_rel_bond_error,max_rel_bond_error,order,failure\n";
  for (const auto& method : plan.methods)
    for (const int divisor : divisors(plan)) {
      const Trial& t = ledger.at(order_name(method, divisor));
      const double dt = plan.scene.run.dt_fs / divisor;
      text += t.failed()
                  ? fmt::format("{},{:.6g},,,,,{}\n", csv_cell(method), dt, csv_cell(t.failure))
                  : fmt::format("{},{:.6g},{:.6e},{:.6e},{:.6e},{:.3f},\n", csv_cell(method), dt, t.figure,
                                t.rms_error.value, t.max_error, order_of(plan, ledger, method));
    }
  return text;
}

std::string length_csv(const ChartPlan& plan, const Ledger& ledger) {
  std::string text =
      "method,bonds,chains,ns_per_bond_step_q1,ns_per_bond_step,ns_per_bond_step_q3,max_rel_bond_error,"
      "failure\n";
  for (const auto& method : plan.methods)
    for (const int bonds : lengths(plan)) {
      const std::string name = length_name(method, bonds);
      const Trial& first = ledger.at(repeat_name(name, 0));
      const Quartiles ns = cost(name, plan.repeats, bonds * copies(plan, bonds), ledger);
      text += first.failed() ? fmt::format("{},{},{},,,,,{}\n", csv_cell(method), bonds, copies(plan, bonds),
                                           csv_cell(first.failure))
                             : fmt::format("{},{},{},{:.4g},{:.4g},{:.4g},{:.3e},\n", csv_cell(method), bonds,
                                           copies(plan, bonds), ns.low, ns.median, ns.high, first.max_error);
    }
  return text;
}

std::string failures_csv(const ChartPlan& plan, const Ledger& ledger) {
  std::string text = "panel,setting,steps_survived,reason\n";
  const auto add = [&](const char* panel, const std::string& name, const Trial& t) {
    if (t.failed()) text += fmt::format("{},{},{},{}\n", panel, csv_cell(name), t.steps, csv_cell(t.failure));
  };
  for (const Setting& s : plan.settings()) {
    if (plan.has("work")) add("work", s.name(), ledger.at(repeat_name(work_name(s), 0)));
    if (plan.has("drift")) add("drift", s.name(), ledger.at(drift_name(s)));
  }
  for (const auto& method : plan.methods) {
    if (plan.has("order"))
      for (const int divisor : divisors(plan))
        add("order", fmt::format("{} at {:g} fs", method, plan.scene.run.dt_fs / divisor),
            ledger.at(order_name(method, divisor)));
    if (plan.has("length"))
      for (const int bonds : lengths(plan))
        add("length", fmt::format("{}, {} bonds", method, bonds),
            ledger.at(repeat_name(length_name(method, bonds), 0)));
  }
  for (const auto& [name, trial] : precision_trials(plan, ledger)) add("precision", name, trial);
  return text;
}

double order_of(const ChartPlan& plan, const Ledger& ledger, const std::string& method) {
  Slope slope;
  int points = 0;
  for (const int divisor : divisors(plan)) {
    const Trial& t = ledger.at(order_name(method, divisor));
    if (t.failed() || !(t.figure > 1e-12)) continue;
    slope.add(-std::log(divisor), std::log(t.figure));
    ++points;
  }
  return points > 1 ? slope.value() : 0.0;
}

}  // namespace taut
