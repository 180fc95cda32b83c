#pragma once

#include <string>
#include <vector>

#include "simulation/simulation.hpp"
#include "studies/study_scene.hpp"
#include "systems/scene/scene.hpp"

namespace taut {

// A point of a curve: a method with one of its settings changed.
struct Setting {
  std::string method;                  // as it was named: "rattle", "rattle:sweeps=4"
  std::string parameter;               // "tolerance", "sweeps", "order", ...; empty: nothing is changed
  std::string value;                   // of the parameter
  std::vector<std::string> overrides;  // what makes it so, as --set takes it

  std::string curve() const { return parameter.empty() ? method : method + " (" + parameter + ")"; }
  std::string name() const { return parameter.empty() ? method : method + ":" + parameter + "=" + value; }
};

// A method with the settings that its word names, as it is.
Setting setting_of(const std::string& method);

// The settings of a method worth a curve at a step h [ps]: whatever its Options have of tolerance, sweeps,
// order, gains, ...; of a word that names settings itself, that alone. `few`: two or three points a curve.
std::vector<Setting> settings_of(const std::string& method, double h, bool few);

// What a run came to, as far as it went. Errors of bonds, and the drift, are of the rows at rest: those after
// TrialPlan::start.
struct Trial {
  long steps = 0;                         // survived
  double constraint_us = 0, step_us = 0;  // a step
  double max_error = 0;                   // of a row's worst bond, relative, mean over the rows
  Estimate rms_error = {};                // relative, of a bond, over the rows
  double later_over_earlier = 1;          // rms of the later half of the rows over that of the earlier
  Estimate error_slope = {};              // of a row's rms in time [1/ns]
  double drift = 0;                       // [kJ/mol/ns/degree of freedom]
  double drift_error = 0;                 // its standard error, as the run has it; 0 for too few rows
  Estimate constraint_drift = {};         // the bonds' share of it
  double kT = 0;                          // 2⟨E_kin⟩ a degree of freedom [kJ/mol]
  double figure = 0;         // what the study asks for besides: rms distance [nm], largest stable step [fs]
  std::string failure = {};  // how it failed, in a few words; empty: it did not

  bool failed() const { return !failure.empty(); }
  double drift_low() const { return drift - 1.96 * drift_error; }  // 95 %
  double drift_high() const { return drift + 1.96 * drift_error; }
  // Whether the errors have no trend: one of more than four of its own errors that sets the halves a tenth apart.
  bool at_rest() const;
  // Whether the drift is at most a tenth of kT a nanosecond and degree of freedom but for three of its standard errors,
  // and known to be less than kT, with two.
  bool keeps_energy() const;
  bool may_keep_energy() const;  // the first alone: the run may be too short to tell
};

struct TrialPlan {
  long start = 0;  // steps before those that are measured: no method has its history in the first ones
  long steps = 1000;
  long rows = 100;  // looked at so many times
  double broken_energy =
      1.0;  // |E − E₀| over the largest kinetic energy seen (or 1e-6 of E₀), above which it blew up
  double broken_bond = 0.1;  // relative error above which a bond counts as lost
};

// A run of a copy of the scene under a setting, some steps at a time.
class TrialRun {
 public:
  TrialRun(Scene scene, const Setting& setting, const TrialPlan& plan);

  // Takes steps, whose time is what trial() has. Throws SimulationFailure, also where energy or bonds broke.
  void advance(long steps);
  Trial trial() const;
  Simulation& simulation() { return simulation_; }
  const std::vector<std::string>& doubts() const {
    return doubts_;
  }  // of the whole run, as `taut run` has them

 private:
  void watch(const Record& r);

  TrialPlan plan_;
  Simulation simulation_;
  std::vector<double> t_, squares_, largest_;  // of the rows at rest: [ps], rms² and the worst bond's error
  RunningSlope energy_, constraint_work_;
  long rows_ = 0, last_row_ = 0;
  double first_energy_ = 0, largest_kinetic_ = 0, kinetic_sum_ = 0;
  double constraint_us_ = 0, step_us_ = 0;
  std::vector<std::string> doubts_;
};

// Runs a copy of the scene under a setting. Failures of every kind come back in Trial::failure.
Trial try_setting(Scene scene, const Setting& setting, const TrialPlan& plan);

// Its final state too, where somebody compares positions.
Trial try_setting(Scene scene, const Setting& setting, const TrialPlan& plan, State& end);

// "0.10 ± 0.31": to two digits of the error; the value alone where that is not known.
std::string in_two_digits(const Estimate& estimate);

// "A is singular" from a failure's whole paragraph.
std::string in_few_words(const std::string& failure);

constexpr int kRowsForInterval = 20;  // with fewer a drift has no error

}  // namespace taut
