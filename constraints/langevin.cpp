#include "constraints/langevin.hpp"

#include <fmt/format.h>

#include <cmath>

#include "md/errors.hpp"
#include "md/observables.hpp"
#include "md/units.hpp"

namespace taut {
namespace {

System with_bonds(System sys, bool wanted) {
  if (!wanted) sys.bonds.clear();
  return sys;
}

constexpr std::uint64_t kStream = 0x6c616e676576696e;  // not the numbers the start was drawn from

}  // namespace

Langevin::Langevin(const System& sys, const Bath& bath, double h)
    : bath_(bath),
      h_(h),
      tangent_(with_bonds(sys, !bath.free_bonds)),
      projector_(tangent_, {}, h),
      half_jump_(Vectors::Zero(3, sys.atoms())),
      before_(half_jump_),
      push_(half_jump_),
      random_(bath.seed ^ kStream) {}

SolveStats Langevin::project(Vectors& x, Vectors& v) {
  scratch_.x.swap(x);
  scratch_.v.swap(v);
  const SolveStats stats = projector_.project_velocities(tangent_, h_, scratch_);
  scratch_.x.swap(x);
  scratch_.v.swap(v);
  return {.worst_bond = stats.worst_bond, .failure = stats.failure};  // not a solve of the method
}

// h = 0 is the start: v is the full-step velocity, half a kick before the drift, and there is no Δ_old.
SolveStats Langevin::draw(const System& sys, double h, State& s) {
  const bool start = h == 0;
  const double c = std::exp(-bath_.friction * h_), kick = start ? 0.5 * h_ : h_;
  before_.swap(half_jump_);
  if (start) before_.setZero();
  for (int i = 0; i < sys.atoms(); ++i) {
    const double width = std::sqrt((1 - c * c) * kBoltzmann * bath_.temperature * sys.inv_mass[i]);
    const Vec3 v = s.v.col(i) + before_.col(i) + kick * sys.inv_mass[i] * s.f.col(i);
    half_jump_.col(i) = 0.5 * ((c - 1) * v + width * random_.normal_vector());
  }
  const SolveStats stats = project(s.x, half_jump_);
  if (bath_.hold_momentum) remove_momentum(sys, half_jump_);
  for (int i = 0; i < sys.atoms(); ++i)
    push_.col(i) = sys.mass[i] / kick * (before_.col(i) + half_jump_.col(i));
  s.f += push_;
  return stats;
}

void Langevin::second_half(State& s) const {
  s.f -= push_;
  s.v += before_;
}

Vectors Langevin::middle_velocity(const System& sys, const State& s) {
  State middle = s;
  half_kick(sys, h_, middle);
  const SolveStats stats = project(middle.x, middle.v);
  if (!stats.converged()) throw SimulationFailure(fmt::format("the temperature: {}", stats.failure));
  return middle.v;
}

}  // namespace taut
