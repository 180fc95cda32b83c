#pragma once

#include "md/integrator.hpp"

namespace taut {

// Velocity Verlet (Swope, Andersen, Berens and Wilson 1982, doi:10.1063/1.442716) with constraints. With positions x,
// velocities v, masses M, the step h, forces F(x), and constraints σ(x) = 0 whose Jacobian is J = ∂σ/∂x:
//     v½ = v + (h/2) M⁻¹f,   x' = x + h v½,   v' = v½ + (h/2) M⁻¹f',   f = F + C,   C = Jᵀλ.
// A method finds λ in up to three places (md/constraint_method.hpp): it moves x' onto σ = 0 and v½ by as much over h,
// takes the part of v' along the bonds out, σ̇ = Jv' = 0 (RATTLE: Andersen 1983, doi:10.1016/0021-9991(83)90014-1; SHAKE
// does the first alone), or adds C to the forces at x', so that σ follows its law in the drift to come. What moves
// the box does so between drift and forces; what scales velocities does so at the step's end.
class VelocityVerlet final : public Integrator {
 public:
  void initialize(const Dynamics& dynamics, double h, State& s) override;
  SolveStats advance(const Dynamics& dynamics, double h, State& s) override;
};

// A single step, whose account is dropped.
inline SolveStats step(const Dynamics& dynamics, double h, State& s) {
  return VelocityVerlet().advance(dynamics, h, s);
}

}  // namespace taut
