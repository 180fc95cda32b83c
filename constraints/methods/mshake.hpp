#pragma once

#include "constraints/methods/newton.hpp"

namespace taut {

// Newton with the exact matrix: M-SHAKE (Kräutler, van Gunsteren, Hünenberger 2001,
// doi:10.1002/1096-987X(20010415)22:5<501::AID-JCC1021>3.0.CO;2-V), as ILVES does for chains and proteins
// (López-Villellas et al. 2025). Positions: x += M⁻¹J(x_old)ᵀg with
//     A'(x) Δg = −σ(x),   A' = J(x) M⁻¹ J(x_old)ᵀ = ∂σ/∂g,
// factored anew at every x: each iteration squares the error, however far the bonds have turned. Velocities
// as Newton's. Differs from the paper: the velocities are projected too, as in RATTLE, and multipliers set
// out from those of the step before. Cost: a factorization (not symmetric) an iteration, and one for the
// velocities; newton takes two to three times the iterations, each without one (constraints/README.md).
class MShake final : public Newton {
 public:
  struct Options : Newton::Options {};

  MShake(const System& sys, const Options& options, double h) : Newton(sys, options, h), exact_(sys) {}

 private:
  bool solve(Eigen::VectorXd& b, SolveStats& stats) override;

  DirectSolver exact_;
};

}  // namespace taut
