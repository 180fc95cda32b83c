#pragma once

#include "base/worse.hpp"
#include "md/system.hpp"

namespace taut {

// The algebra of rigid bonds. For bond k = (i, j): r = x_j − x_i, v_ij = v_j − v_i,
//     σ = ½(|r|² − d²),   σ̇ = r·v_ij,   σ̈ = r·a_ij + |v_ij|²,
// row k of J has −r at i and +r at j, and a constraint force is f_c = Jᵀλ.
// Arrays over bonds are 3 × m or m, arrays over atoms 3 × n. Arrays of all bonds have the one-sided ones
// last.

inline double sigma(const Vec3& r, double d) {
  return 0.5 * (r.squaredNorm() - d * d);
}

// r_k = x_j − x_i; also v_ij from v
void differences(const System& sys, const Vectors& x, Vectors& r);

// f += Jᵀλ, with r the bond vectors of J
void add_constraint_force(const System& sys, const Vectors& r, const Eigen::VectorXd& lambda, Vectors& f);

// y += M⁻¹Jᵀλ
void add_constraint_acceleration(const System& sys, const Vectors& r, const Eigen::VectorXd& lambda,
                                 Vectors& y);

// Tension of each bond that is held from both sides, −λd [kJ/mol/nm], positive when it pulls its atoms
// together.
Eigen::VectorXd tensions(const System& sys, const Eigen::VectorXd& lambda);

// Largest |σ|/d² over the bonds and where it is (−1 without bonds). NaN counts as largest.
struct Residual {
  double value = 0;
  int bond = -1;

  void see(double relative, int k) {
    if (!worse(relative, value)) return;
    value = relative;
    bond = k;
  }
};

}  // namespace taut
