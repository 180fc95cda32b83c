#pragma once

#include <string>
#include <vector>

#include "constraints/methods/propagator.hpp"
#include "studies/ledger.hpp"

namespace taut {

// Where methods fail: Baumgarte over the plane of its gains, and every method with the length of its step.
struct StabilityPlan {
  std::vector<Scene> scenes = {};  // the plane is the first one's
  std::vector<std::string> methods = {};
  bool quick = false;
  long plane_steps = 2000;
  long step_steps = 500;                 // a step is stable that gets through so many
  double broken_bond = 0.1;              // a run has failed where a bond is off by more than this, relative,
  double broken_energy = 1;              // or the energy by this much of the largest kinetic energy
  std::vector<double> ah = {}, bh = {};  // αh and βh of the plane's points, as asked; empty: all of it

  void make_quick();  // rough: few gains and steps
  std::vector<double> all_ah() const;
  std::vector<double> all_bh() const;
  TrialPlan trial(long trial_steps) const;
};

constexpr double kSearch = 64;  // a stable step is looked for from 1/64 to 64 times the scene's

//   plane   steps survived, drift and bond errors of Baumgarte at (αh, βh), for each damping;
//           newton's drift is the one to beat (NAN: it failed)
//   steps   the largest stable step of each method on each scene, by bisection, how it fails beyond, and the
//           largest at which it keeps the energy (Trial::keeps_energy), in runs four times as long
std::vector<Job> plane_jobs(const StabilityPlan& plan);
std::vector<Job> step_jobs(const StabilityPlan& plan);

std::string plane_csv(const StabilityPlan& plan, const Ledger& ledger);
std::string steps_csv(const StabilityPlan& plan, const Ledger& ledger);

// The limit, βh against αh, for each damping (Propagator).
std::string limits_csv();

// Trial::figure is the largest stable step [fs], 0 if none was found; Trial::failure how the next one fails.
Trial largest_stable_step(const StabilityPlan& plan, const Scene& scene, const std::string& method);

// What the study found of a method on a scene, by its place in the plan.
struct LargestSteps {
  const Trial& runs;          // as largest_stable_step has it
  const Trial& keeps_energy;  // its figure is that step [fs], its drift and kT are those there
};
LargestSteps largest_steps(const Ledger& ledger, std::size_t scene, const std::string& method);

}  // namespace taut
