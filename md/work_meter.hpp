#pragma once

#include <vector>

#include "base/archive.hpp"
#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// Sums the work of the forces F (without those of constraints) and the heat of thermostat and barostat. The
// kinetic energy of velocity Verlet changes in a step by
//     ΔK = ½(f_n + f_{n+1})·Δx + ⅛h² Δ(Σ|f|²/m),   Δx = h v_half,
// exactly, where f = F + C are all forces. The part of the energy E = K + U that F and U do not account for,
//     ΔK − ½(F_n + F_{n+1})·Δx  =  ½(C_n + C_{n+1})·Δx + ⅛h² Δ(Σ|f|²/m),
// is then what the constraints did, up to a function of the state. With C = Jᵀλ their work in a step is
//     ½(C_n + C_{n+1})·Δx  =  Σ ½(λ_n + λ_{n+1})Δσ + ¼(λ_{n+1} − λ_n)|Δr|².
// The second share, ½(F_n + F_{n+1})·Δx + ΔU, is the error of the forces: of the step's length, and of their
// jumps.
//
// Where a thermostat changes v_half to v_half + Δ in the middle of the drift, x moves by h(v_half + ½Δ), and
// exactly
//     ΔK = ½h (f_n·v_half + f_{n+1}·(v_half + Δ)) + ⅛h² Δ(Σ|f|²/m) + Q,   Q = Σ m (v_half + ½Δ)·Δ:
// Q, by which Δ changes the kinetic energy, is the heat, the third share; the two others are as above, each
// with the velocity of its own half of the step. (Heat is what the random substep gives, work what the others
// do: Sivak, Chodera and Crooks 2013, doi:10.1103/PhysRevX.3.011007.) Rigid bonds that turn in the drift take
// a part out of the second half of Δ. That part belongs to the heat, too; ensembles/langevin.hpp says how
// much it is.
class WorkMeter {
 public:
  // Adds a step, after F is evaluated in it: s.v is v_half, or v_half + ½Δ with half_jump = ½Δ under a bath.
  void add_step(double h, const System& sys, const State& s, const Vectors* half_jump = nullptr);
  void add_heat(double heat) { heat_ += heat; }  // velocities were changed between steps [kJ/mol]

  double work() const { return work_; }              // Σ of the forces', so far [kJ/mol]
  double heat() const { return heat_; }              // Σ Q so far [kJ/mol]
  const Vectors& forces() const { return before_; }  // F of the last step [kJ/mol/nm]

  void serialize(Archive& archive) { archive(work_, heat_); }
  // Sets F where the state is, after serialize() has loaded the sums of another meter.
  void set_forces(const Vectors& f) { before_ = f; }

 private:
  double work_ = 0, heat_ = 0;
  Vectors before_;  // F at the step before
  struct Sums {
    double work = 0, heat = 0;  // Σ (F_before + F)·v + (F − F_before)·½Δ, Σ m v·½Δ
  };
  std::vector<Sums> parts_;  // by thread
};

}  // namespace taut
