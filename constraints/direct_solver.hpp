#pragma once

#include <vector>

#include "base/archive.hpp"
#include "constraints/elimination.hpp"

namespace taut {

// Assembles and solves with A = J M⁻¹Jᵀ,
//     A_kk = (1/m_i + 1/m_j)|r_k|²,   A_kl = ±(r_k·r_l)/m_a,
// with 1/m weighed where virtual sites bear bonds (Couplings), or with A' = J(x')M⁻¹J(x)ᵀ, A'_kl = ±(r'_k·r_l)/m_a, which is not symmetric: the exact derivative of σ(x')
// with respect to multipliers that act along J(x). It takes clusters of any shape. The cost is linear in the
// number of bonds for chains, trees and small molecules. Neither factor() nor solve() allocates.
class DirectSolver {
 public:
  explicit DirectSolver(const System& sys);

  // r: 3 × m bond vectors. A bond whose pivot is below `threshold` times its diagonal depends on other bonds:
  // it gets λ = 0, and dependent_bonds() lists it. Pivots of A' are negative where the bonds have passed a placement in
  // which they depend on each other; a bond that has turned by 90° or more is dependent, too.
  void factor(const Vectors& r, double threshold = 1e-12) { factor(r, r, threshold); }
  void factor(const Vectors& r_new, const Vectors& r, double threshold = 1e-12);
  void solve(Eigen::VectorXd& b);  // b ← A⁻¹b, m

  void serialize(Archive& archive) { archive(l_, u_, inv_d_); }  // the factors
  const std::vector<int>& dependent_bonds() const { return dependent_; }
  bool singular() const { return !dependent_.empty(); }
  int clusters() const { return plan_.clusters(); }

 private:
  explicit DirectSolver(const Couplings& couplings);

  Eigen::VectorXd reduced_inv_mass_;
  Elimination plan_;
  Eigen::VectorXd l_, u_, a_, d_, inv_d_, work_;
  std::vector<int> dependent_;
};

}  // namespace taut
