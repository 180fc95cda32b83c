#include "md/velocity_verlet.hpp"

#include "md/diagnosis.hpp"

namespace taut {

void VelocityVerlet::initialize(const Dynamics& dynamics, double h, State& s) {
  s.f.resize(3, dynamics.sys.atoms());
  dynamics.forces.evaluate(dynamics.sys, s);  // f = F(x)
  s.F = s.f;
  const SolveStats stats = dynamics.add_forces(Push::at_start(h), s);  // f = F + C
  demand_converged(dynamics.sys, s, stats, 0);
}

SolveStats VelocityVerlet::advance(const Dynamics& dynamics, double h, State& s) {
  const System& sys = dynamics.sys;
  dynamics.set_off(h, s);                                   // v½ of anchors that move
  half_kick_and_drift(sys, h, nullptr, s);                  // v½ = v + (h/2) M⁻¹f,  x' = x + h v½
  s.t += h;                                                 // forces that depend on time act at the new one
  SolveStats stats = dynamics.project_positions(h, s);      // σ(x') = 0, and v½ by as much over h
  account.heat += dynamics.bath.move_box(sys, s);           // a barostat scales box, x' and v½
  dynamics.forces.evaluate(sys, s);                         // f' = F(x')
  renew_forces(h, sys, nullptr, s);                         // work += ½(F + F')·Δx, then F is F'
  stats += dynamics.add_forces(Push::between_steps(h), s);  // f' = F' + C'
  half_kick(sys, h, nullptr, s);                            // v' = v½ + (h/2) M⁻¹f'
  stats += dynamics.project_velocities(h, s);               // σ̇ = Jv' = 0
  if (stats.held()) account.heat += dynamics.after_step(h, s);  // thermostat, barostat
  return stats;
}

}  // namespace taut
