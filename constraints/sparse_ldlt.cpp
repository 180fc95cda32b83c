#include "constraints/sparse_ldlt.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <numeric>

namespace taut {
namespace {

std::vector<int> components_of(int n, const std::vector<SparseLdlt::Pair>& pairs) {
  std::vector<int> root(n);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int a) {
    while (root[a] != a) a = root[a] = root[root[a]];
    return a;
  };
  for (const auto& [a, b] : pairs) root[std::max(find(a), find(b))] = std::min(find(a), find(b));
  for (int a = 0; a < n; ++a) root[a] = find(a);
  return root;
}

}  // namespace

SparseLdlt::SparseLdlt(int n, const std::vector<Pair>& pairs) : inv_d_(n), work_(Eigen::VectorXd::Zero(n)) {
  order(n, pairs);
  find_fill(pairs);
  dependent_.reserve(n);
}

void SparseLdlt::order(int n, const std::vector<Pair>& pairs) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int a = 0; a < n; ++a) entries.emplace_back(a, a, 1.0);
  for (const auto& [a, b] : pairs) {
    entries.emplace_back(a, b, 1.0);
    entries.emplace_back(b, a, 1.0);
  }
  Eigen::SparseMatrix<double> pattern(n, n);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  if (n > 0) Eigen::AMDOrdering<int>()(pattern, permutation);

  old_of_new_.assign(permutation.indices().data(), permutation.indices().data() + permutation.size());
  const std::vector<int> component = components_of(n, pairs);
  std::stable_sort(old_of_new_.begin(), old_of_new_.end(),
                   [&](int a, int b) { return component[a] < component[b]; });
  new_of_old_.resize(n);
  for (int p = 0; p < n; ++p) {
    new_of_old_[old_of_new_[p]] = p;
    components_ += component[p] == p;
  }
}

void SparseLdlt::find_fill(const std::vector<Pair>& pairs) {
  const int n = static_cast<int>(new_of_old_.size());
  std::vector<std::vector<std::array<int, 2>>> above(n);  // column k: rows i < k with their value's index
  for (int e = 0; e < static_cast<int>(pairs.size()); ++e) {
    const auto [i, k] = std::minmax(new_of_old_[pairs[e][0]], new_of_old_[pairs[e][1]]);
    above[k].push_back({i, e});
  }
  // Row k of L: the paths in the elimination tree from each entry of A's column k up to k.
  std::vector<int> parent(n, -1), seen_for(n, -1), count(n, 0);
  std::vector<std::vector<int>> rows(n);
  a_start_.assign(1, 0);
  for (int k = 0; k < n; ++k) {
    seen_for[k] = k;
    for (const auto& [row, e] : above[k]) {
      a_row_.push_back(row);
      a_value_.push_back(e);
      for (int i = row; seen_for[i] != k; i = parent[i]) {
        if (parent[i] < 0) parent[i] = k;
        seen_for[i] = k;
        rows[k].push_back(i);
      }
    }
    a_start_.push_back(static_cast<int>(a_row_.size()));
    std::sort(rows[k].begin(), rows[k].end());  // children before parents
    for (int i : rows[k]) ++count[i];
  }
  column_start_.assign(n + 1, 0);
  std::partial_sum(count.begin(), count.end(), column_start_.begin() + 1);
  column_row_.resize(column_start_[n]);
  values_.resize(column_start_[n]);
  std::vector<int> next(column_start_.begin(), column_start_.end() - 1);
  row_start_.assign(1, 0);
  for (int k = 0; k < n; ++k) {
    for (int i : rows[k]) {
      row_entry_.push_back({i, next[i]});
      column_row_[next[i]++] = k;
    }
    row_start_.push_back(static_cast<int>(row_entry_.size()));
  }
}

void SparseLdlt::factor(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& values, double threshold) {
  dependent_.clear();
  const int n = static_cast<int>(inv_d_.size());
  for (int k = 0; k < n; ++k) {
    // Solve L y = A's column k above the diagonal; then l_ki = y_i/d_i and d_k = a_kk − Σ l_ki y_i.
    for (int e = a_start_[k]; e < a_start_[k + 1]; ++e) work_[a_row_[e]] = values[a_value_[e]];
    const double a_kk = diagonal[old_of_new_[k]];
    double d = a_kk;
    for (int e = row_start_[k]; e < row_start_[k + 1]; ++e) {
      const auto [i, position] = row_entry_[e];
      const double y = work_[i];
      work_[i] = 0;
      for (int p = column_start_[i]; p < position; ++p) work_[column_row_[p]] -= values_[p] * y;
      values_[position] = y * inv_d_[i];
      d -= values_[position] * y;
    }
    if (d > threshold * a_kk) {
      inv_d_[k] = 1 / d;
    } else {  // also true for NaN
      inv_d_[k] = 0;
      dependent_.push_back(old_of_new_[k]);
    }
  }
}

void SparseLdlt::solve(Eigen::VectorXd& b) {
  const int n = static_cast<int>(inv_d_.size());
  for (int k = 0; k < n; ++k) work_[k] = b[old_of_new_[k]];
  for (int i = 0; i < n; ++i)
    for (int p = column_start_[i]; p < column_start_[i + 1]; ++p)
      work_[column_row_[p]] -= values_[p] * work_[i];
  for (int i = n - 1; i >= 0; --i) {
    double z = work_[i] * inv_d_[i];
    for (int p = column_start_[i]; p < column_start_[i + 1]; ++p) z -= values_[p] * work_[column_row_[p]];
    work_[i] = z;
  }
  for (int k = 0; k < n; ++k) b[old_of_new_[k]] = work_[k];
  work_.setZero();
}

int SparseLdlt::fill() const {
  return static_cast<int>(column_row_.size() - a_row_.size());
}

}  // namespace taut
