#pragma once

#include <string>
#include <utility>
#include <vector>

#include "constraints/methods/baumgarte.hpp"
#include "studies/study_scene.hpp"
#include "systems/scene/scene.hpp"

namespace taut {

// Which gains make Baumgarte reduce a bond error by as much a step as a reference method does?
//
// An error of `size` is put into a run that has settled, on all bonds, at random: a stretch (σ =
// size·d²·normal) or a rate (σ̇ = size·d²/h·normal), always along M⁻¹Jᵀ. The run with it and the run without
// are followed side by side; the difference of their σ, rms over bonds in units of d², is the error's own
// course, free of the floor that both share.
struct CalibrationPlan {
  std::string against =
      "rattle";    // rattle, shake, newton, or one that was added; with settings: rattle:sweeps=4
  int sweeps = 0;  // more than 0: the reference (rattle, shake) takes just so many
  // What gains copy of a reference whose errors do not shrink alike from step to step:
  //   mean     its mean reduction down to a twentieth: roots that and 0
  //   first    its first step's: roots that and 0
  //   slowest  the course of the error that its sweeps leave most of (swept_errors.hpp): rattle and sweeps
  //   alone
  std::string copies = "mean";
  std::string damping = "discrete";
  double size = 1e-6;          // of the error put in, relative
  int settle = 50;             // steps before
  int steps = 40;              // steps followed
  long compared_steps = 2000;  // of the runs that methods are compared in
};

// An error's course: rms over bonds of σ/d², and of σ̇h/d² with σ̇ = (σ₊ − σ₋)/2h, step by step.
struct ErrorCourse {
  std::vector<double> stretch;
  std::vector<double> rate;
};

// The reference's course where bonds are tied together alike, beside what its sweeps are known to do.
struct ShapeCourse {
  std::string name;  // "216 clusters of 3 bonds"
  std::vector<double> foretold, measured;
};

struct Calibration {
  std::string reference_method;              // in a word, "rattle:sweeps=4"
  int sweeps = 0;                            // of it; 0: to a tolerance
  int window = 0;                            // steps over which reductions are taken
  double reduction_reference = 0;            // a step, of a stretch, as plan.copies asks
  std::vector<ShapeCourse> shapes;           // of rattle with so many sweeps
  Baumgarte::Options method;                 // what was measured, to the last digit: gains = "rattle"
  double alpha_per_ps = 0, beta_per_ps = 0;  // what that comes to
  // A step, by Baumgarte with these gains: a stretch's σ and σ̇, and the σ of a rate put in; by the
  // propagator, and measured. Of an error that swings: of its squares' sums.
  struct Reduction {
    double predicted = 0, measured = 0;
  };
  Reduction of_stretch, of_rate, after_rate;
  double floor_predicted = 0, floor_measured = 0;  // rms over bonds and steps of σ/d², nothing put in
  double rounding = 0;                             // what rounding positions leaves of it
  std::vector<double> foretold;                    // Baumgarte's course of the stretch, by the propagator
  ErrorCourse reference, baumgarte;                // of a stretch
};

// Throws InputError for a scene without bonds or a reference that is not one of the three.
Calibration calibrate(const Scene& scene, const CalibrationPlan& plan);

// By how much a method reduces a stretch a step, measured, and what the law says where it is Baumgarte's (else NaN).
Calibration::Reduction reduction_of(const Scene& scene, const MethodOptions& method,
                                    const CalibrationPlan& plan);

// All figures of one, by name.
std::vector<std::pair<const char*, double>> figures_of(const Calibration& c);

// Where a measured figure is more than a twentieth off the predicted one: which, why, and what to do, in a
// line; else empty.
std::string disagreement(const CalibrationPlan& plan, const Calibration& c);

// The method measured in a word, as every command takes it: "baumgarte:gains=rattle,reduction=0.0286585".
std::string method_of(const Calibration& c);

}  // namespace taut
