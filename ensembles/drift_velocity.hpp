#pragma once

#include <memory>

#include "md/constraint_method.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// The velocity of the drift ahead of a full step, on the tangent of the bonds,
//     u = P(v + (h/2)M⁻¹f),   P = 1 − M⁻¹Jᵀ A⁻¹ J.
// It is canonical for free and for harmonic motion at any step, where v is too cold by (ωh)²/4 (docs/ensembles.md).
// Thermostats act on it, and temperatures and the pressure are of it. P's solve is that of `newton`, on threads.
class DriftVelocity {
 public:
  explicit DriftVelocity(const System& sys);

  // u of a state with its forces; Pv for a step h of 0. Throws SimulationFailure where bonds depend on each other.
  const Vectors& of(double h, const State& s);
  // v becomes Pv.
  SolveStats project(double h, const Vectors& x, Vectors& v);

  const System& tangent() const { return tangent_; }

 private:
  System tangent_;                               // the atoms, and all bonds on both sides
  std::unique_ptr<ConstraintMethod> projector_;  // whose velocities are P's
  State at_;                                     // x and v as it takes them
};

// v + (h/2)M⁻¹f, with what it has along the bonds.
void find_kicked_velocity(const System& sys, double h, const State& s, Vectors& v);

}  // namespace taut
