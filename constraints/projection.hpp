#pragma once

#include <vector>

#include "constraints/direct_solver.hpp"
#include "md/velocity_verlet.hpp"

namespace taut {

// Moves positions onto σ = 0 and velocities onto σ̇ = 0 by the smallest mass-weighted change, and finds the
// exact multipliers of a state. It is meant for start-up, tests and analysis: each call factors A anew.
class Projector {
 public:
  explicit Projector(const System& sys);

  // Iterates J M⁻¹ Jᵀ g = −σ, x += M⁻¹Jᵀg (Newton) until |σ|/d² stops at round-off. Throws SimulationFailure,
  // which names the bond, if bonds depend on each other or no solution is near.
  void positions(const System& sys, Vectors& x);

  // v −= M⁻¹Jᵀ A⁻¹ J v
  void velocities(const System& sys, const Vectors& x, Vectors& v);

  // Solves A λ = −(J M⁻¹f + |v_ij|²), σ̈ = 0 at this instant. s.f must not contain constraint forces. To M⁻¹f comes the
  // acceleration of anchors that move (MovingAnchors::accelerations), where it is given.
  const Eigen::VectorXd& multipliers(const System& sys, const State& s, const Vectors* prescribed = nullptr);

  // b ← A⁻¹b, A of the positions where multipliers or velocities were found last.
  void solve(Eigen::VectorXd& b) { solver_.solve(b); }

  int clusters() const { return solver_.clusters(); }

 private:
  DirectSolver solver_;
  Vectors r_, v_ij_;   // 3 × m, bond vectors and their rates of change
  Eigen::VectorXd b_;  // m, right-hand side, then solution
};

// Sets the velocities of anchors (atoms of mass 0) to 0, and returns those that were not 0 before.
std::vector<int> rest_anchors(const System& sys, Vectors& v);

// Makes a start satisfy the bonds, its anchors at rest, or at the beginning of their motion. Throws SimulationFailure,
// naming the bond, where it cannot.
void bring_to_bonds(const System& sys, State& s, MovingAnchors* anchors = nullptr);

// Brings a start to the bonds, and gives forces their first values by an integrator; velocity Verlet if none is given.
void initialize(Integrator& integrator, const Dynamics& dynamics, double h, State& s);
void initialize(const Dynamics& dynamics, double h, State& s);

}  // namespace taut
