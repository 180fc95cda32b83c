#include "constraints/sparse_ldlt.hpp"

namespace taut {

SparseLdlt::SparseLdlt(int n, const std::vector<SparsePattern::Pair>& pairs)
    : pattern_(n, pairs), l_(pattern_.column_row.size()), inv_d_(n), work_(Eigen::VectorXd::Zero(n)) {
  dependent_.reserve(n);
}

void SparseLdlt::factor(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& values, double threshold) {
  const SparsePattern& P = pattern_;
  dependent_.clear();
  for (int k = 0; k < P.size(); ++k) {
    for (int e = P.a_start[k]; e < P.a_start[k + 1]; ++e) work_[P.a_row[e]] = values[P.a_pair[e]];
    const double a_kk = diagonal[P.old_of_new[k]];
    double d = a_kk;
    for (int e = P.row_start[k]; e < P.row_start[k + 1]; ++e) {
      const auto [i, position] = P.row_entry[e];
      const double y = work_[i];
      work_[i] = 0;
      for (int p = P.column_start[i]; p < position; ++p) work_[P.column_row[p]] -= l_[p] * y;
      l_[position] = y * inv_d_[i];
      d -= l_[position] * y;
    }
    const bool independent = d > threshold * a_kk;  // false for NaN
    inv_d_[k] = independent ? 1 / d : 0.0;
    if (!independent) dependent_.push_back(P.old_of_new[k]);
  }
}

void SparseLdlt::solve(Eigen::VectorXd& b) {
  const SparsePattern& P = pattern_;
  const int n = P.size();
  for (int k = 0; k < n; ++k) work_[k] = b[P.old_of_new[k]];
  for (int i = 0; i < n; ++i)
    for (int p = P.column_start[i]; p < P.column_start[i + 1]; ++p)
      work_[P.column_row[p]] -= l_[p] * work_[i];
  for (int i = n - 1; i >= 0; --i) {
    double z = work_[i] * inv_d_[i];
    for (int p = P.column_start[i]; p < P.column_start[i + 1]; ++p) z -= l_[p] * work_[P.column_row[p]];
    work_[i] = z;
  }
  for (int k = 0; k < n; ++k) b[P.old_of_new[k]] = work_[k];
  work_.setZero();
}

SparseLdu::SparseLdu(int n, const std::vector<SparsePattern::Pair>& pairs)
    : pattern_(n, pairs),
      l_(pattern_.column_row.size()),
      u_(l_.size()),
      inv_d_(n),
      work_(Eigen::VectorXd::Zero(n)),
      work_row_(work_) {
  dependent_.reserve(n);
}

// As above, with column k of U and row k of L each found by its own substitution.
void SparseLdu::factor(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& values,
                       const Eigen::VectorXd& mirrored, double threshold) {
  const SparsePattern& P = pattern_;
  dependent_.clear();
  for (int k = 0; k < P.size(); ++k) {
    for (int e = P.a_start[k]; e < P.a_start[k + 1]; ++e) {
      const int pair = P.a_pair[e];
      work_[P.a_row[e]] = P.a_flipped[e] ? mirrored[pair] : values[pair];
      work_row_[P.a_row[e]] = P.a_flipped[e] ? values[pair] : mirrored[pair];
    }
    const double a_kk = diagonal[P.old_of_new[k]];
    double d = a_kk;
    for (int e = P.row_start[k]; e < P.row_start[k + 1]; ++e) {
      const auto [i, position] = P.row_entry[e];
      const double up = work_[i], left = work_row_[i];
      work_[i] = work_row_[i] = 0;
      for (int p = P.column_start[i]; p < position; ++p) {
        work_[P.column_row[p]] -= l_[p] * up;
        work_row_[P.column_row[p]] -= u_[p] * left;
      }
      u_[position] = up * inv_d_[i];
      l_[position] = left * inv_d_[i];
      d -= l_[position] * up;
    }
    const bool independent = d > threshold * a_kk;  // false for NaN
    inv_d_[k] = independent ? 1 / d : 0.0;
    if (!independent) dependent_.push_back(P.old_of_new[k]);
  }
}

void SparseLdu::solve(Eigen::VectorXd& b) {
  const SparsePattern& P = pattern_;
  const int n = P.size();
  for (int k = 0; k < n; ++k) work_[k] = b[P.old_of_new[k]];
  for (int i = 0; i < n; ++i)
    for (int p = P.column_start[i]; p < P.column_start[i + 1]; ++p)
      work_[P.column_row[p]] -= l_[p] * work_[i];
  for (int i = n - 1; i >= 0; --i) {
    double z = work_[i] * inv_d_[i];
    for (int p = P.column_start[i]; p < P.column_start[i + 1]; ++p) z -= u_[p] * work_[P.column_row[p]];
    work_[i] = z;
  }
  for (int k = 0; k < n; ++k) b[P.old_of_new[k]] = work_[k];
  work_.setZero();
}

}  // namespace taut
