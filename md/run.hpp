#pragma once

#include <functional>
#include <string>

#include "base/errors.hpp"
#include "md/step.hpp"

namespace taut {

struct RunPlan {
  double h = 0;  // [ps]
  long steps = 0;
  long observe_every = 100;  // steps, at least 1: so often a run also looks whether numbers are finite
  double broken_at = 0.5;    // |σ|/d² from which a bond counts as broken
};

// What an observer sees.
struct Observation {
  long step;
  const SolveStats& since;  // worst residual and sum of iterations since the last observation
};

// Why a step failed, as far as the state it left and the one before tell.
struct Diagnosis {
  long step = 0;
  double t = 0;                          // [ps]
  std::string cause;                     // the method's or the force's words
  int bond = -1;                         // −1: none to blame
  RigidBond held{-1, -1, 0};             // its atoms and target [nm]
  double length = 0, length_before = 0;  // now, and in the state before the step where it is known [nm]
  double largest_force = 0;              // [kJ/mol/nm]
  int atom = 0;                          // on which
  std::string advice;

  std::string text() const;  // one clear paragraph
};
Diagnosis diagnose(const System& sys, const State& s, const SolveStats& stats, long step);

// A step was taken and its solves do not hold, or its numbers ran away.
struct StepFailure : SimulationFailure {
  StepFailure(const Diagnosis& diagnosis, const SolveStats& of_step)
      : SimulationFailure(diagnosis.text()), stats(of_step) {}

  SolveStats stats;
};

// Throws SimulationFailure, the diagnosis, where a solve has failed.
void demand_converged(const System& sys, const State& s, const SolveStats& stats, long step);

// A step of a run. Where it does not hold nothing more is done.
SolveStats take_step(const Dynamics& dynamics, const RunPlan& plan, State& s);
bool holds(const SolveStats& stats, const RunPlan& plan);

// How far a run has come. Kept in a checkpoint, it goes on as if nothing had been.
struct RunProgress {
  long step = 0;     // taken so far
  SolveStats since;  // worst residual and sum of iterations since the last observation

  void serialize(Archive& archive) { archive(step, since.iterations, since.max_residual, since.worst_bond); }
};

// Who looks at a run; either may be left out.
struct Watch {
  std::function<void(const Observation&)> observe = {};  // every plan.observe_every steps
  std::function<bool(long)> go_on = {};                  // then, after every step: whether to
};

// Takes the steps that are left of plan.steps. Returns whether all were taken. Throws StepFailure where a
// solve fails and, at an observation, where a number is not finite; forces refuse positions that are not finite in
// every step. Throws InputError for a plan that cannot be carried out.
bool run(const Dynamics& dynamics, const RunPlan& plan, RunProgress& progress, State& s,
         const Watch& watch = {});

}  // namespace taut
