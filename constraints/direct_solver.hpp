#pragma once

#include <vector>

#include "constraints/sparse_ldlt.hpp"
#include "md/system.hpp"

namespace taut {

// Assembles and solves with A = J M⁻¹ Jᵀ. Two bonds k, l couple where they share an atom a that can move:
//     A_kk = (1/m_i + 1/m_j)|r_k|²,   A_kl = ±(r_k·r_l)/m_a,
// + where a is the same end (i or j) of both, − otherwise. Plain and exact, any shape of cluster;
// the cost is linear in bonds for chains, trees and small molecules.
class DirectSolver {
 public:
  explicit DirectSolver(const System& sys);

  // r: 3 × m bond vectors. Bonds found to depend on others get λ = 0 and are named by dependent_bonds().
  void factor(const Vectors& r);
  void solve(Eigen::VectorXd& b) { ldlt_.solve(b); }  // b ← A⁻¹b, m

  const std::vector<int>& dependent_bonds() const { return ldlt_.dependent_rows(); }
  bool singular() const { return !dependent_bonds().empty(); }
  int clusters() const { return ldlt_.components(); }  // sets of coupled bonds

 private:
  struct Coupling {
    int k, l;
    double signed_inv_mass;
  };
  static std::vector<Coupling> couplings_of(const System& sys);
  static std::vector<SparseLdlt::Pair> pairs_of(const std::vector<Coupling>& couplings);

  std::vector<Coupling> couplings_;
  SparseLdlt ldlt_;
  Eigen::VectorXd reduced_inv_mass_;  // 1/m_i + 1/m_j, m
  Eigen::VectorXd diagonal_, values_;
};

}  // namespace taut
