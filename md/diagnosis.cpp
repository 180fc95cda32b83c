#include "md/diagnosis.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

namespace taut {
namespace {

// For one-sided bonds, which not every method holds.
std::string_view one_sided_advice(Failure failure) {
  switch (failure) {
    case Failure::kTurned:
    case Failure::kSingularOrTurned:
      return "the bond turns too fast for the step: take a shorter one, or a cooler start";
    case Failure::kNoConvergence:
    case Failure::kVelocitiesNoConvergence:
      return "take a shorter step, a looser tolerance, or more sweeps (method.max_sweeps of rattle)";
    default:
      return "take a shorter step, or rattle, which holds bonds more firmly";
  }
}

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
  d.advice = sys.one_sided.empty() ? advice(stats.failure) : one_sided_advice(stats.failure);
  if (stats.worst_bond >= 0) {
    d.bond = stats.worst_bond;
    d.held = sys.bond(d.bond);
    d.length = sys.along(d.held, s.x).norm();
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

}  // namespace taut
