#pragma once

#include "base/exceeds.hpp"
#include "md/system.hpp"

namespace taut {

// The algebra of rigid bonds. For bond k = (i, j): r = x_j − x_i, v_ij = v_j − v_i,
//     σ = ½(|r|² − d²),   σ̇ = r·v_ij,   σ̈ = r·a_ij + |v_ij|²,
// row k of J has −r at i and +r at j (c r at each atom that bears the bond: md/system.hpp), and a constraint force is
// f_c = Jᵀλ.
// Arrays over bonds are 3 × m or m, arrays over atoms 3 × n. One-sided bonds come after the ordinary ones.

inline double sigma(const Vec3& r, double d) {
  return 0.5 * (r.squaredNorm() - d * d);
}

// Returns λ if a one-sided bond may have it (a strut, side 1, only pushes; a rope, side −1, only pulls), else
// 0. A bond that acts both ways has side 0.
inline double one_sided(int side, double lambda) {
  return side == 0 || side * lambda > 0 ? lambda : 0;
}

// r_k = x_j − x_i, where a cluster meets its own image, of nearest images
void bond_vectors(const System& sys, const Vectors& x, Vectors& r);

// v_ij from v
void differences(const System& sys, const Vectors& x, Vectors& r);

// f += Jᵀλ, with r the bond vectors of J
void add_constraint_force(const System& sys, const Vectors& r, const Eigen::VectorXd& lambda, Vectors& f);

// y += M⁻¹Jᵀλ
void add_constraint_acceleration(const System& sys, const Vectors& r, const Eigen::VectorXd& lambda,
                                 Vectors& y);

// The same of bond k alone, with λr.
inline void add_constraint_acceleration(const System& sys, int k, const Vec3& pull, Vectors& y) {
  sys.for_each_bearer(sys.bond(k), [&](int a, double c) { y.col(a) += c * sys.inv_mass[a] * pull; });
}

// Returns the tension −λd [kJ/mol/nm] of each ordinary bond; it is positive if the bond pulls its atoms
// together.
Eigen::VectorXd tensions(const System& sys, const Eigen::VectorXd& lambda);

// Returns the largest |σ|/d² and its bond (−1 if there are none). A NaN counts as the largest.
struct Residual {
  double value = 0;
  int bond = -1;

  void see(double relative, int k) {
    if (!exceeds(relative, value)) return;
    value = relative;
    bond = k;
  }
};

}  // namespace taut
