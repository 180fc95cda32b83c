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
struct Moment {
  long step;
  const SolveStats& since;  // worst residual and sum of iterations since the last observation
};

// One clear paragraph: which step, bond, lengths, largest force, likely cause, what to try.
std::string explain_failure(const System& sys, const State& s, const SolveStats& stats, long step);

// Takes plan.steps steps. `each(s)` is called after every step (a thermostat), `observe(Moment)` every so
// often and after the last. Throws SimulationFailure before numbers turn into NaN.
template <ForceLaw F, ConstraintMethod M, class Bath = NoBath>
void run(const System& sys, F& forces, M& method, const RunPlan& plan, State& s, auto&& each, auto&& observe,
         Bath&& bath = Bath{}) {
  SolveStats since;
  for (long n = 1; n <= plan.steps; ++n) {
    const SolveStats stats = step(sys, forces, method, plan.h, s, bath);
    if (!stats.converged() || !(stats.max_residual < plan.broken_at))
      throw SimulationFailure(explain_failure(sys, s, stats, n));
    since += stats;
    each(s);
    if (plan.remove_momentum_every > 0 && n % plan.remove_momentum_every == 0) remove_momentum(sys, s.v);
    if (n % plan.observe_every == 0 || n == plan.steps) {
      if (!s.x.allFinite() || !s.f.allFinite()) throw SimulationFailure(explain_failure(sys, s, stats, n));
      observe(Moment{n, since});
      since = {};
    }
  }
}

}  // namespace taut
