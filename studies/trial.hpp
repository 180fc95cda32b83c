#pragma once

#include <string>
#include <vector>

#include "studies/study_scene.hpp"
#include "systems/scene.hpp"

namespace taut {

// A point of a curve: a method with one of its settings changed.
struct Setting {
  std::string method;
  std::string parameter;               // "tolerance", "sweeps", "order", ...; empty: all at their defaults
  std::string value;                   // of the parameter
  std::vector<std::string> overrides;  // what makes it so, as --set takes it

  std::string curve() const { return parameter.empty() ? method : method + " (" + parameter + ")"; }
  std::string name() const { return parameter.empty() ? method : method + ":" + parameter + "=" + value; }
};

// The settings of a method worth a curve at a step h [ps]: whatever its Options have of tolerance, sweeps,
// order, gains, ... `few`: two or three points a curve.
std::vector<Setting> settings_of(const std::string& method, double h, bool few);

// What a run came to, as far as it went.
struct Trial {
  long steps = 0;                         // survived
  double constraint_us = 0, step_us = 0;  // a step
  double max_error = 0, rms_error = 0;    // relative, of a bond, over the rows
  double drift = 0;                       // [kJ/mol/ns/degree of freedom]
  double drift_error = 0;                 // its standard error, as the run has it; 0 for too few rows
  double constraint_drift = 0;            // the bonds' share of it
  double figure = 0;    // what the study asks for besides: rms distance [nm], largest stable step [fs]
  std::string failure;  // how it failed, in a few words; empty: it did not

  bool failed() const { return !failure.empty(); }
  double drift_low() const { return drift - 1.96 * drift_error; }  // 95 %
  double drift_high() const { return drift + 1.96 * drift_error; }
};

struct TrialPlan {
  long steps = 1000;
  long rows = 100;  // looked at so many times
  double broken_energy =
      1.0;  // |E − E₀| over the largest kinetic energy seen (or 1e-6 of E₀), above which it blew up
  double broken_bond = 0.1;  // relative error above which a bond counts as lost
  Listen listen = {};
};

// Runs a copy of the scene under a setting. Failures of every kind come back in Trial::failure.
Trial try_setting(Scene scene, const Setting& setting, const TrialPlan& plan);

// Its final state too, where somebody compares positions.
Trial try_setting(Scene scene, const Setting& setting, const TrialPlan& plan, State& end);

// "A is singular" from a failure's whole paragraph.
std::string in_few_words(const std::string& failure);

constexpr int kRowsForInterval = 20;  // with fewer a drift has no error

}  // namespace taut
