#include "md/run.hpp"

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace taut {
namespace {

std::string_view advice(Failure failure) {
  switch (failure) {
    case Failure::kTurned:
    case Failure::kSingularOrTurned:
      return "the bond turns too fast for the step: take a shorter one, or a cooler start; where "
             "the bars of a linkage come into one line (a dead point), newton";
    case Failure::kSingular:
      return "bonds lie in line or in a plane, so that no force can hold them all: drop one, or bend them; "
             "where they swing through that line (a dead point), newton";
    case Failure::kNoConvergence:
    case Failure::kVelocitiesNoConvergence:
      return "take a shorter step, a looser tolerance, or more sweeps; where sweeps fail at any step, "
             "newton or feedforward, which solve all bonds at once";
    default:
      return "take a shorter step, or a method that holds bonds more firmly (newton, rattle)";
  }
}

}  // namespace

Diagnosis diagnose(const System& sys, const State& s, const SolveStats& stats, long step) {
  Diagnosis d;
  d.step = step;
  d.t = s.t;
  d.cause = stats.converged() ? "a bond broke or a number ran away" : in_words(stats.failure);
  d.advice = advice(stats.failure);
  if (stats.worst_bond >= 0) {
    d.bond = stats.worst_bond;
    d.held = sys.bond(d.bond);
    d.length = (s.x.col(d.held.j) - s.x.col(d.held.i)).norm();
  }
  Eigen::Index atom = 0;
  if (s.f.cols() > 0) d.largest_force = std::sqrt(s.f.colwise().squaredNorm().maxCoeff(&atom));
  d.atom = static_cast<int>(atom);
  return d;
}

std::string Diagnosis::text() const {
  const std::string blamed = bond < 0 ? "no bond to blame"
                                      : fmt::format("bond {} (atoms {}-{}) is {:.6g} nm, held at {:.6g} nm",
                                                    bond, held.i, held.j, length, held.length);
  return fmt::format(
      "step {} (t = {:.6g} ps): {}\n  {}\n  largest force: {:.4g} kJ/mol/nm on atom {}\n  try: {}", step, t,
      cause, blamed, largest_force, atom, advice);
}

void demand_converged(const System& sys, const State& s, const SolveStats& stats, long step) {
  if (!stats.converged()) throw SimulationFailure(diagnose(sys, s, stats, step).text());
}

bool bonds_hold(const SolveStats& stats, const RunPlan& plan) {
  return stats.converged() && stats.max_residual < plan.broken_at;
}

SolveStats take_step(const Dynamics& dynamics, const RunPlan& plan, State& s) {
  const SolveStats stats = step(dynamics, plan.h, s);
  if (bonds_hold(stats, plan)) dynamics.bath.after_step(dynamics.sys, plan.h, s);
  return stats;
}

bool run(const Dynamics& dynamics, const RunPlan& plan, RunProgress& progress, State& s, const Watch& watch) {
  const auto fail = [&](const SolveStats& stats) {
    throw StepFailure(diagnose(dynamics.sys, s, stats, progress.step), stats);
  };
  if (plan.observe_every < 1)
    throw InputError(fmt::format("a run's observe_every is {}, expected 1 or more", plan.observe_every));
  while (progress.step < plan.steps) {
    const long n = ++progress.step;
    const SolveStats stats = take_step(dynamics, plan, s);
    if (!bonds_hold(stats, plan)) fail(stats);
    progress.since += stats;
    if (n % plan.observe_every == 0) {
      if (!s.x.allFinite() || !s.f.allFinite()) fail(stats);
      const SolveStats since = std::exchange(progress.since, {});  // even if the observer throws
      if (watch.observe) watch.observe({n, since});
    }
    if (watch.go_on && !watch.go_on(n)) return false;
  }
  return true;
}

}  // namespace taut
