#pragma once

#include <functional>
#include <string>

#include "base/errors.hpp"
#include "md/step.hpp"

namespace taut {

struct RunPlan {
  double h = 0;  // [ps]
  long steps = 0;
  long observe_every = 100;  // steps, at least 1; a run also checks then that its numbers are finite
  double broken_at = 0.5;    // |σ|/d² from which a bond counts as broken
};

// What an observer is told.
struct Observation {
  long step;
  const SolveStats& since;  // worst residual and sum of iterations since the last observation
};

// Why a step failed, judged by the state that it left and, where it is known, the state before.
struct Diagnosis {
  long step = 0;
  double t = 0;                          // [ps]
  std::string cause;                     // in the words of the method or the force
  int bond = -1;                         // the bond to blame; −1: none
  RigidBond held{-1, -1, 0};             // its atoms and target [nm]
  double length = 0, length_before = 0;  // now, and in the state before the step where it is known [nm]
  double largest_force = 0;              // [kJ/mol/nm]
  int atom = 0;                          // on which
  std::string advice;

  std::string text() const;  // one clear paragraph
};
Diagnosis diagnose(const System& sys, const State& s, const SolveStats& stats, long step);

// A step was taken, but its solves did not converge, a bond broke or a number is not finite.
struct StepFailure : SimulationFailure {
  StepFailure(const Diagnosis& diagnosis, const SolveStats& of_step)
      : SimulationFailure(diagnosis.text()), stats(of_step) {}

  SolveStats stats;
};

// Throws SimulationFailure with the diagnosis where a solve has failed.
void demand_converged(const System& sys, const State& s, const SolveStats& stats, long step);

// Takes a step of a run. Where its bonds do not hold, the bath's end of the step is left out.
SolveStats take_step(const Dynamics& dynamics, const RunPlan& plan, State& s);
// True where the solves of a step converged and no bond broke.
bool bonds_hold(const SolveStats& stats, const RunPlan& plan);

// How far a run has come. A checkpoint keeps it.
struct RunProgress {
  long step = 0;     // taken so far
  SolveStats since;  // worst residual and sum of iterations since the last observation

  void serialize(Archive& archive) { archive(step, since.iterations, since.max_residual, since.worst_bond); }
};

// Callbacks of a run; either may be left out.
struct Watch {
  std::function<void(const Observation&)> observe = {};  // every plan.observe_every steps
  std::function<bool(long)> go_on = {};  // after every step and its observation; false stops the run
};

// Takes the steps that are left of plan.steps. Returns true if all were taken. Throws StepFailure where a
// solve fails and, at an observation, where a number is not finite (forces refuse positions that are not
// finite in every step). Throws InputError for a plan that cannot be carried out.
bool run(const Dynamics& dynamics, const RunPlan& plan, RunProgress& progress, State& s,
         const Watch& watch = {});

}  // namespace taut
