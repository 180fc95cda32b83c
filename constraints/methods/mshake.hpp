#pragma once

#include "constraints/methods/newton.hpp"

namespace taut {

// Newton's method with the exact matrix: M-SHAKE (Kräutler, van Gunsteren, Hünenberger 2001,
// doi:10.1002/1096-987X(20010415)22:5<501::AID-JCC1021>3.0.CO;2-V), as ILVES does for chains and proteins
// (López-Villellas et al. 2025). Positions: x += M⁻¹J(x_old)ᵀg with
//     A'(x) Δg = −σ(x),   A' = J(x) M⁻¹ J(x_old)ᵀ = ∂σ/∂g,
// which is factored anew at every x, so that each iteration squares the error however far the bonds have
// turned. Velocities are projected as in Newton. Differs from the paper: velocities are projected, too, as in
// RATTLE, and the multipliers start from those of the previous step. Cost: one unsymmetric factorization per
// iteration, and one for the velocities. Newton takes two to three times as many iterations, none with a
// factorization (constraints/README.md).
class MShake final : public Newton {
 public:
  struct Options : Newton::Options {};

  MShake(const System& sys, const Options& options, double h) : Newton(sys, options, h) {}

 private:
  bool solve(Eigen::VectorXd& b, SolveStats& stats) override;
};

}  // namespace taut
