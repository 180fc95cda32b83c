#pragma once

#include <vector>

#include "constraints/direct_solver.hpp"
#include "md/step.hpp"

namespace taut {

// Brings a start to C = 0 and Ċ = 0, by the shortest way in the metric of the masses, and finds the exact
// multipliers of a state. For start-up, tests and analysis: it factors anew at every call.
class Projector {
 public:
  explicit Projector(const System& sys);

  // Newton's iteration J M⁻¹ Jᵀ g = −σ, x += M⁻¹Jᵀg, until |σ|/d² stays at round-off.
  // Throws SimulationFailure, naming the bond, where bonds depend on each other or no solution is near.
  void positions(const System& sys, Vectors& x);

  // v −= M⁻¹Jᵀ A⁻¹ J v
  void velocities(const System& sys, const Vectors& x, Vectors& v);

  // A λ = −(J M⁻¹f + |v_ij|²): what holds the bonds at this very instant. f is without constraint forces.
  const Eigen::VectorXd& multipliers(const System& sys, const State& s);

  int clusters() const { return solver_.clusters(); }

 private:
  DirectSolver solver_;
  Vectors r_, v_ij_;   // 3 × m
  Eigen::VectorXd b_;  // m
};

// v ← 0 for atoms of mass 0, which no force could stop. Which of the anchors moved.
std::vector<int> rest_anchors(const System& sys, Vectors& v);

// Makes the start of a run with steps of length h [ps] satisfy the bonds, and gives f its first value, constraint
// forces included. Throws
// SimulationFailure, naming the bond, where the bonds or the method cannot hold the start.
void initialize(const Dynamics& dynamics, double h, State& s);

}  // namespace taut
