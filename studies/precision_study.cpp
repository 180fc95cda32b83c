#include <fmt/format.h>

#include "measures/csv.hpp"
#include "studies/chart_study.hpp"
#include "studies/repeats.hpp"

namespace taut {
namespace {

std::string name_of(Precision precision) {
  return precision == Precision::kMixed ? "mixed" : "double";
}

std::string point_name(const char* panel, const std::string& method, Precision precision) {
  return fmt::format("{}/{}/{}", panel, method, name_of(precision));
}

Trial try_precision(const ChartPlan& plan, const std::string& method, Precision precision,
                    const TrialPlan& trial) {
  Scene scene = plan.scene;
  scene.terms.precision = precision;
  return try_setting(std::move(scene), setting_of(method), trial);
}

}  // namespace

bool has_precisions(const Scene& scene) {
  return scene.terms.nonbonded || scene.terms.wca || scene.terms.tabulated_pairs;
}

std::vector<Job> precision_jobs(const ChartPlan& plan, const Ledger& ledger) {
  if (!plan.has("precision")) return {};
  std::vector<Job> points, drifts;
  for (const auto& method : plan.methods)
    for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
      points.push_back({point_name("step", method, precision), [&plan, method, precision] {
                          return try_precision(plan, method, precision,
                                               {.start = plan.steps, .steps = plan.steps, .rows = 2});
                        }});
      drifts.push_back({point_name("precision", method, precision), [&plan, method, precision] {
                          return try_precision(plan, method, precision, plan.long_trial());
                        }});
    }
  std::vector<Job> jobs = interleaved(points, plan.repeats, ledger);
  jobs.insert(jobs.end(), drifts.begin(), drifts.end());
  return jobs;
}

std::vector<std::pair<std::string, Trial>> precision_trials(const ChartPlan& plan, const Ledger& ledger) {
  std::vector<std::pair<std::string, Trial>> trials;
  if (plan.has("precision"))
    for (const auto& method : plan.methods)
      for (const Precision precision : {Precision::kDouble, Precision::kMixed})
        trials.emplace_back(fmt::format("{}, {}", method, name_of(precision)),
                            ledger.at(point_name("precision", method, precision)));
  return trials;
}

std::string precision_csv(const ChartPlan& plan, const Ledger& ledger) {
  std::string text =
      "method,precision,step_us_q1,step_us,step_us_q3,drift_kj_mol_ns_dof,drift_low,drift_high,"
      "constraint_drift_kj_mol_ns_dof,"
      "rms_rel_bond_error,max_rel_bond_error,failure\n";
  for (const auto& method : plan.methods)
    for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
      const Trial& t = ledger.at(point_name("precision", method, precision));
      const Quartiles us =
          over_repeats(point_name("step", method, precision), plan.repeats, ledger, &Trial::step_us);
      text +=
          t.failed()
              ? fmt::format("{},{},,,,,,,,,,{}\n", csv_cell(method), name_of(precision), csv_cell(t.failure))
              : fmt::format("{},{},{:.5g},{:.5g},{:.5g},{:.6e},{:.6e},{:.6e},{:.6e},{:.6e},{:.6e},\n",
                            csv_cell(method), name_of(precision), us.low, us.median, us.high, t.drift,
                            t.drift_low(), t.drift_high(), t.constraint_drift.value, t.rms_error.value,
                            t.max_error);
    }
  return text;
}

}  // namespace taut
