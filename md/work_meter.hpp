#pragma once

#include "md/archive.hpp"
#include "md/state.hpp"

namespace taut {

// The work of the forces F, constraints' left out. Velocity Verlet's kinetic energy changes in a step by
//     ΔK = ½(f_n + f_{n+1})·Δx + ⅛h² Δ(Σ|f|²/m),   Δx = h v_half,
// without remainder, f = F + C being all forces. So the energy E = K + U that F and U do not account for,
//     ΔK − ½(F_n + F_{n+1})·Δx  =  ½(C_n + C_{n+1})·Δx + ⅛h² Δ(Σ|f|²/m),
// is what the constraints did, but for a function of the state; with C = Jᵀλ the work of a step is
//     ½(C_n + C_{n+1})·Δx  =  Σ ½(λ_n + λ_{n+1})Δσ + ¼(λ_{n+1} − λ_n)|Δr|².
// The other share, ½(F_n + F_{n+1})·Δx + ΔU, is the forces': what the step's length and their jumps do.
class WorkMeter {
 public:
  // After F is evaluated in a step: s.v is still the half step's, which came here.
  void see(double h, const State& s) {
    if (before_.size() > 0) work_ += 0.5 * h * (before_ + s.f).cwiseProduct(s.v).sum();
    before_ = s.f;
  }
  double work() const { return work_; }  // Σ ½(F_n + F_{n+1})·Δx so far [kJ/mol]

  void serialize(Archive& archive) { archive(work_); }
  void recall(const Vectors& f) { before_ = f; }  // F where the state is, after another one's serialize()

 private:
  double work_ = 0;
  Vectors before_;  // F at the step before
};

}  // namespace taut
