#pragma once

#include <Eigen/Core>
#include <vector>

#include "constraints/sparse_pattern.hpp"
#include "md/archive.hpp"

namespace taut {

// A = L D Lᵀ, A symmetric and positive, a row of L at a time: l_ki = y_i/d_i and d_k = a_kk − Σ l_ki y_i,
// with y from L y = A's column k above the diagonal. Straight loops, nothing allocated.
class SparseLdlt {
 public:
  SparseLdlt(int n, const std::vector<SparsePattern::Pair>& pairs);

  // A from its diagonal (n) and the entries at `pairs`, in their order. A row whose pivot is less than
  // `threshold` of its diagonal depends on others: its unknown is held at zero.
  void factor(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& values, double threshold = 1e-12);
  void solve(Eigen::VectorXd& b);  // b ← A⁻¹b

  void serialize(Archive& archive) { archive(l_, inv_d_); }
  const std::vector<int>& dependent_rows() const { return dependent_; }
  const SparsePattern& pattern() const { return pattern_; }

 private:
  SparsePattern pattern_;
  Eigen::VectorXd l_, inv_d_, work_;
  std::vector<int> dependent_;
};

// A = L D U, A with a symmetric pattern but not symmetric itself; no pivoting, for matrices near a positive
// one.
class SparseLdu {
 public:
  SparseLdu(int n, const std::vector<SparsePattern::Pair>& pairs);

  // `values[e]` and `mirrored[e]` are A's entries at pairs[e] = (row, column) and at (column, row).
  void factor(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& values, const Eigen::VectorXd& mirrored,
              double threshold = 1e-12);
  void solve(Eigen::VectorXd& b);  // b ← A⁻¹b

  const std::vector<int>& dependent_rows() const { return dependent_; }

 private:
  SparsePattern pattern_;
  Eigen::VectorXd l_, u_, inv_d_, work_, work_row_;
  std::vector<int> dependent_;
};

}  // namespace taut
