#include "ensembles/drift_velocity.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"
#include "base/shares.hpp"
#include "constraints/registry.hpp"
#include "md/diagnosis.hpp"

namespace taut {
namespace {

System without_one_sided(System sys) {
  sys.one_sided.clear();
  return sys;
}

}  // namespace

DriftVelocity::DriftVelocity(const System& sys)
    : tangent_(without_one_sided(sys)),
      projector_(make_method(tangent_, default_options("newton"), 1)) {}  // velocities know no step

const Vectors& DriftVelocity::of(double h, const State& s) {
  at_.x = s.x;
  find_kicked_velocity(tangent_, h, s, at_.v);
  if (tangent_.bonds.empty()) return at_.v;
  const SolveStats stats = projector_->project_velocities(tangent_, h, at_);
  if (!stats.converged())
    throw SimulationFailure(fmt::format("the temperature: {}", in_words(stats.failure)));
  return at_.v;
}

SolveStats DriftVelocity::project(double h, const Vectors& x, Vectors& v) {
  if (tangent_.bonds.empty()) return {};
  at_.x = x;
  at_.v.swap(v);
  const SolveStats stats = projector_->project_velocities(tangent_, h, at_);
  at_.v.swap(v);
  return {.worst_bond = stats.worst_bond, .failure = stats.failure};  // not a solve of the method
}

void find_kicked_velocity(const System& sys, double h, const State& s, Vectors& v) {
  v.resize(3, sys.atoms());
  by_atoms(sys.atoms(), [&](int first, int last) {
    for (int i = first; i < last; ++i) v.col(i) = s.v.col(i) + 0.5 * h * sys.inv_mass[i] * s.f.col(i);
  });
}

}  // namespace taut
