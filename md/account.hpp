#pragma once

#include "base/archive.hpp"

namespace taut {

// The work of the forces F (without those of constraints) and the heat of thermostat and barostat, so far. The
// kinetic energy of velocity Verlet changes in a step by
//     ΔK = ½(f_n + f_{n+1})·Δx + ⅛h² Δ(Σ|f|²/m),   Δx = h v½,
// exactly, where f = F + C are all forces. The part of the energy E = K + U that F and U do not account for,
//     ΔK − ½(F_n + F_{n+1})·Δx  =  ½(C_n + C_{n+1})·Δx + ⅛h² Δ(Σ|f|²/m),
// is then what the constraints did, up to a function of the state. With C = Jᵀλ their work in a step is
//     ½(C_n + C_{n+1})·Δx  =  Σ ½(λ_n + λ_{n+1})Δσ + ¼(λ_{n+1} − λ_n)|Δr|².
// The second share, ½(F_n + F_{n+1})·Δx + ΔU, is the error of the forces: of the step's length, and of their
// jumps.
//
// Where a thermostat changes v½ to v½ + Δ in the middle of the drift, x moves by h(v½ + ½Δ), and
// exactly
//     ΔK = ½h (f_n·v½ + f_{n+1}·(v½ + Δ)) + ⅛h² Δ(Σ|f|²/m) + Q,   Q = Σ m (v½ + ½Δ)·Δ:
// Q, by which Δ changes the kinetic energy, is the heat, the third share; the two others are as above, each
// with the velocity of its own half of the step. (Heat is what the random substep gives, work what the others
// do: Sivak, Chodera and Crooks 2013, doi:10.1103/PhysRevX.3.011007.) Rigid bonds that turn in the drift take
// a part out of the second half of Δ. That part belongs to the heat, too; ensembles/langevin.hpp says how
// much it is.
struct Account {
  double work = 0, heat = 0;  // [kJ/mol]

  void serialize(Archive& archive) { archive(work, heat); }
};

}  // namespace taut
