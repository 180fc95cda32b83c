#pragma once

#include <vector>

#include "base/archive.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// The work of the forces F, constraints' left out, and a bath's heat. Velocity Verlet's kinetic energy
// changes in a step by
//     ΔK = ½(f_n + f_{n+1})·Δx + ⅛h² Δ(Σ|f|²/m),   Δx = h v_half,
// without remainder, f = F + C being all forces. So the energy E = K + U that F and U do not account for,
//     ΔK − ½(F_n + F_{n+1})·Δx  =  ½(C_n + C_{n+1})·Δx + ⅛h² Δ(Σ|f|²/m),
// is what the constraints did, but for a function of the state; with C = Jᵀλ the work of a step is
//     ½(C_n + C_{n+1})·Δx  =  Σ ½(λ_n + λ_{n+1})Δσ + ¼(λ_{n+1} − λ_n)|Δr|².
// The second share, ½(F_n + F_{n+1})·Δx + ΔU, is the forces': what the step's length and their jumps do.
//
// Where a bath changes v_half to v_half + Δ in the middle of the drift, x moves by h(v_half + ½Δ), and
// without remainder
//     ΔK = ½h (f_n·v_half + f_{n+1}·(v_half + Δ)) + ⅛h² Δ(Σ|f|²/m) + Q,   Q = Σ m (v_half + ½Δ)·Δ:
// Q, by which Δ changes the kinetic energy, is the bath's heat, the third share, and each of the two others
// is what it was with the velocity of its own half of the step. (Heat is what the random substep gives, work
// what the other ones do: Sivak, Chodera and Crooks 2013, doi:10.1103/PhysRevX.3.011007.) Rigid bonds that
// turn in the drift take a part of Δ's second half out. That is the bath's, too; langevin.hpp says how much.
class WorkMeter {
 public:
  // Adds a step, after F is evaluated in it: s.v is v_half, or v_half + ½Δ with half_jump = ½Δ under a bath.
  void add_step(double h, const System& sys, const State& s, const Vectors* half_jump = nullptr);
  void add_heat(double heat) { heat_ += heat; }  // velocities were changed between steps [kJ/mol]

  double work() const { return work_; }              // Σ of the forces', so far [kJ/mol]
  double heat() const { return heat_; }              // Σ Q so far [kJ/mol]
  const Vectors& forces() const { return before_; }  // F of the last step [kJ/mol/nm]

  void serialize(Archive& archive) { archive(work_, heat_); }
  void recall(const Vectors& f) { before_ = f; }  // F where the state is, after another one's serialize()

 private:
  double work_ = 0, heat_ = 0;
  Vectors before_;  // F at the step before
  struct Sums {
    double work = 0, heat = 0;  // Σ (F_before + F)·v + (F − F_before)·½Δ, Σ m v·½Δ
  };
  std::vector<Sums> parts_;  // by thread
};

}  // namespace taut
