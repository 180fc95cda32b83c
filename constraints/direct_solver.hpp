#pragma once

#include <vector>

#include "constraints/sparse_ldlt.hpp"
#include "md/system.hpp"

namespace taut {

// Two bonds k, l couple where they share an atom a that can move; the coupling is ±1/m_a, + where a is the
// same end (i or j) of both, − otherwise.
struct Couplings {
  explicit Couplings(const System& sys);

  std::vector<SparsePattern::Pair> pairs;  // (k, l)
  std::vector<double> signed_inv_mass;     // [1/u]
  Eigen::VectorXd reduced_inv_mass;        // 1/m_i + 1/m_j [1/u], m
};

// Assembles and solves with A = J M⁻¹Jᵀ,
//     A_kk = (1/m_i + 1/m_j)|r_k|²,   A_kl = ±(r_k·r_l)/m_a.
// Plain and exact, any shape of cluster; the cost is linear in bonds for chains, trees and small molecules.
class DirectSolver {
 public:
  explicit DirectSolver(const System& sys);

  // r: 3 × m bond vectors. Bonds whose pivot is below `threshold` of the diagonal depend on others: they get
  // λ = 0 and are named by dependent_bonds().
  void factor(const Vectors& r, double threshold = 1e-12);
  void solve(Eigen::VectorXd& b) { ldlt_.solve(b); }  // b ← A⁻¹b, m

  void serialize(Archive& archive) { archive(ldlt_); }  // the factors
  const std::vector<int>& dependent_bonds() const { return ldlt_.dependent_rows(); }
  bool singular() const { return !dependent_bonds().empty(); }
  int clusters() const { return ldlt_.pattern().components; }  // sets of coupled bonds

 private:
  Couplings couplings_;
  SparseLdlt ldlt_;
  Eigen::VectorXd diagonal_, values_;
};

// The same with A' = J(x')M⁻¹J(x)ᵀ, the exact derivative of σ(x') by multipliers that act along J(x):
//     A'_kl = ±(r'_k·r_l)/m_a, not symmetric.
class UnsymmetricSolver {
 public:
  explicit UnsymmetricSolver(const System& sys);

  void factor(const Vectors& r_new, const Vectors& r);
  void solve(Eigen::VectorXd& b) { ldu_.solve(b); }  // b ← A'⁻¹b, m

  const std::vector<int>& dependent_bonds() const { return ldu_.dependent_rows(); }
  bool singular() const { return !dependent_bonds().empty(); }

 private:
  Couplings couplings_;
  SparseLdu ldu_;
  Eigen::VectorXd diagonal_, values_, mirrored_;
};

}  // namespace taut
