#pragma once

#include <string>
#include <vector>

#include "constraints/baumgarte.hpp"
#include "systems/scene.hpp"

namespace taut {

// Which gains make Baumgarte reduce a bond error by as much a step as a reference method does?
//
// An error of `size` is put into a run that has settled, on all bonds, at random: a stretch (σ =
// size·d²·normal) or a rate (σ̇ = size·d²/h·normal), always along M⁻¹Jᵀ. The run with it and the run without
// are followed side by side; the difference of their σ, rms over bonds in units of d², is the error's own
// course, free of the floor that both share.
struct CalibrationPlan {
  std::string against = "rattle";  // rattle, shake or newton
  double tolerance = 1e-10;        // of the reference method, where sweeps = 0
  int sweeps = 0;                  // more than 0: the reference (rattle, shake) takes just so many
  std::string damping = "centred";
  int passes = 2;  // of Baumgarte; one leaves what its guess of λ misses by, which hides small reductions
  double size = 1e-6;  // of the error put in, relative
  int settle = 50;     // steps before
  int steps = 40;      // steps followed
};

// An error's course: rms over bonds of σ/d², and of σ̇h/d² with σ̇ = (σ₊ − σ₋)/2h, step by step.
struct Course {
  std::vector<double> stretch;
  std::vector<double> rate;
};

struct Calibration {
  int window = 0;                            // steps over which reductions are taken
  double reduction_reference = 0;            // a step, of a stretch, from the step that first sees it
  Baumgarte::Options method;                 // what was measured, to the last digit: gains = "rattle"
  double alpha_per_ps = 0, beta_per_ps = 0;  // what that comes to
  double left = 0;                           // share of a stretch that no gain takes away, rms
  double reduction_predicted = 0;            // by the propagator
  // by Baumgarte with these gains: a stretch's σ and σ̇, and the σ of a rate put in
  double reduction_measured = 0, reduction_of_rate = 0, reduction_after_rate = 0;
  double floor_predicted = 0, floor_measured = 0;  // rms over bonds and steps of σ/d², nothing put in
  Course reference, baumgarte;                     // of a stretch
};

// Throws InputError for a scene without bonds or a reference that is not one of the three.
Calibration calibrate(const Scene& scene, const CalibrationPlan& plan);

// Where a measured figure is more than a tenth off the predicted one: which, why, and what to do, in a line;
// else empty.
std::string disagreement(const CalibrationPlan& plan, const Calibration& c);

// The method measured as `taut run --set` takes it, {"method.name=baumgarte", ...}.
std::vector<std::string> settings_of(const Calibration& c);

}  // namespace taut
