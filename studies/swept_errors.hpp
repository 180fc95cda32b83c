#pragma once

#include <string>
#include <vector>

#include "md/system.hpp"

namespace taut {

// What RATTLE with K sweeps, and no more, leaves of small errors of the bonds. A sweep takes σ to
// (1 − A(D + L)⁻¹)σ, with D and L the diagonal of A = J M⁻¹Jᵀ and what is below it: Gauss–Seidel. With T its
// K-th power, positions and then velocities, which the motion of the positions has put off, have
//     σ₊ = T(σ + hσ̇),     hσ̇₊ = T(σ₊ − σ):
// the roots of z² − (t + t²)z + t² for an eigenvalue t of T, a pair of modulus t.
class SweptErrors {
 public:
  SweptErrors(const System& sys, const Vectors& x, int sweeps) : sys_(sys), x_(x), sweeps_(sweeps) {}

  Eigen::VectorXd swept(const Eigen::VectorXd& sigma) const;  // Tσ
  // σ of the steps from a stretch on, σ̇ = 0.
  std::vector<Eigen::VectorXd> course(Eigen::VectorXd stretch, int steps) const;
  double slowest() const;  // |t| of the error that lasts longest

 private:
  const System& sys_;
  const Vectors& x_;
  int sweeps_;
};

// Bonds tied together alike: the same masses and lengths in the same order.
struct SweptShape {
  std::string name;        // "216 clusters of 3 bonds"
  std::vector<int> bonds;  // of all its clusters
};
std::vector<SweptShape> cluster_shapes(const System& sys);

}  // namespace taut
