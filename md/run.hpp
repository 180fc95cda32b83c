#pragma once

#include <string>

#include "md/errors.hpp"
#include "md/observables.hpp"
#include "md/step.hpp"

namespace taut {

struct RunPlan {
  double h = 0;  // [ps]
  long steps = 0;
  long observe_every = 100;        // steps
  long remove_momentum_every = 0;  // steps; 0: never
  double broken_at = 0.5;          // |σ|/d² from which a bond counts as broken
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

// Throws SimulationFailure, the diagnosis, where a solve has failed.
inline void demand_converged(const System& sys, const State& s, const SolveStats& stats, long step) {
  if (!stats.converged()) throw SimulationFailure(diagnose(sys, s, stats, step).text());
}

inline bool holds(const SolveStats& stats, const RunPlan& plan) {
  return stats.converged() && stats.max_residual < plan.broken_at;
}

// Step n of a run: `each(s)` is called after it (a thermostat). Where it does not hold nothing is done to it.
template <ForceLaw F, ConstraintMethod M, class Bath = NoBath>
SolveStats take_step(const System& sys, F& forces, M& method, const RunPlan& plan, long n, State& s,
                     auto&& each, Bath&& bath = Bath{}) {
  const SolveStats stats = step(sys, forces, method, plan.h, s, bath);
  if (!holds(stats, plan)) return stats;
  each(s);
  if (plan.remove_momentum_every > 0 && n % plan.remove_momentum_every == 0) remove_momentum(sys, s.v);
  return stats;
}

// How far a run has come. Kept in a checkpoint, it goes on as if nothing had been.
struct RunProgress {
  long step = 0;     // taken so far
  SolveStats since;  // worst residual and sum of iterations since the last observation

  void serialize(Archive& archive) { archive(step, since.iterations, since.max_residual, since.worst_bond); }
};

// Takes the steps that are left of plan.steps. `observe(Observation)` every so often; then `go_on(step)`,
// after every step, which says whether to. Returns whether all steps were taken. Throws SimulationFailure
// before numbers turn into NaN.
template <ForceLaw F, ConstraintMethod M, class Bath = NoBath>
bool run(const System& sys, F& forces, M& method, const RunPlan& plan, RunProgress& progress, State& s,
         auto&& each, auto&& observe, auto&& go_on, Bath&& bath = Bath{}) {
  while (progress.step < plan.steps) {
    const long n = ++progress.step;
    const SolveStats stats = take_step(sys, forces, method, plan, n, s, each, bath);
    if (!holds(stats, plan)) throw SimulationFailure(diagnose(sys, s, stats, n).text());
    progress.since += stats;
    if (n % plan.observe_every == 0) {
      if (!s.x.allFinite() || !s.f.allFinite()) throw SimulationFailure(diagnose(sys, s, stats, n).text());
      observe(Observation{n, progress.since});
      progress.since = {};
    }
    if (!go_on(n)) return false;
  }
  return true;
}

}  // namespace taut
