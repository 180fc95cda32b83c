#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "studies/chart_verdict.hpp"
#include "studies/ledger.hpp"

namespace taut {

constexpr int kOrderSteps = 16;  // of the scene's own length, over which trajectories are compared
constexpr long kStepsForInterval = 10 * kRowsForInterval;  // of drift_steps: with fewer it has no interval

// A work–precision study: what each method costs against what it gets wrong.
struct ChartPlan {
  Scene scene;
  std::vector<std::string> methods = {};
  bool quick = false;
  int repeats = 20;         // of everything timed; interleaved, so that all meet the same machine
  long steps = 40;          // of a timed run; short, so that few of them meet another process
  long drift_steps = 4000;  // of a run whose energy and bonds are watched
  std::set<std::string, std::less<>> panels = {"work", "drift", "order", "length", "precision"};

  void make_quick();                      // rough: few settings, repeats and steps
  std::vector<Setting> settings() const;  // of all methods
  // Of drift_steps, after a start of a quarter as many.
  TrialPlan long_trial() const {
    return {.start = drift_steps / 4, .steps = drift_steps, .rows = drift_steps / 10};
  }
  bool has(
      std::string_view panel) const;  // asked for, or needed for one that is, and there is something to show
};

// Panels, each with its jobs, and its table as CSV once they are done.
//   work    constraint time a bond and step, quartiles over the repeats; bond errors of the runs of drift
//   drift   of the energy, with its interval, against the times of work
//   Both leave the start of a run out, where methods have no history and the scene may not be at rest.
//   order   distance from a reference run (newton, 1e-12, at a fine step) after a short time, step by step
//   length  constraint time a bond against the length of freely jointed chains
//   precision  time of a whole step, drift and bond errors with pair forces in double and in mixed precision;
//           none where there are no pair forces
std::vector<Job> work_jobs(const ChartPlan& plan, const Ledger& ledger);  // and of drift
std::vector<Job> order_jobs(const ChartPlan& plan);
std::vector<Job> length_jobs(const ChartPlan& plan, const Ledger& ledger);
std::vector<Job> precision_jobs(const ChartPlan& plan, const Ledger& ledger);
std::vector<Job> chart_jobs(const ChartPlan& plan, const Ledger& ledger);  // of all the plan's panels

std::string work_csv(const ChartPlan& plan, const Ledger& ledger);
std::string drift_csv(const ChartPlan& plan, const Ledger& ledger);
std::string order_csv(const ChartPlan& plan, const Ledger& ledger);
std::string length_csv(const ChartPlan& plan, const Ledger& ledger);
std::string precision_csv(const ChartPlan& plan, const Ledger& ledger);
// What the panels work and drift come to, of each setting that got through the first.
std::vector<ChartPoint> chart_points(const ChartPlan& plan, const Ledger& ledger);
// Those whose bond errors are not at rest, with what the later half of a run has over the earlier.
std::vector<std::string> not_at_rest(const ChartPlan& plan, const Ledger& ledger);
bool has_precisions(const Scene& scene);
// The drifts of that panel, "newton, mixed".
std::vector<std::pair<std::string, Trial>> precision_trials(const ChartPlan& plan, const Ledger& ledger);

// The panels by their names, and "failures".
std::vector<std::pair<std::string, std::string>> chart_tables(const ChartPlan& plan, const Ledger& ledger);

// Who failed where, and why: panel, setting, reason.
std::string failures_csv(const ChartPlan& plan, const Ledger& ledger);

// Least-squares slope of log(distance) against log(h) for a method, over the steps where it did not fail and
// stands clear of its own floor.
double order_of(const ChartPlan& plan, const Ledger& ledger, const std::string& method);

}  // namespace taut
