#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace taut {

// P A Pᵀ = L D Lᵀ of a sparse symmetric positive matrix whose pattern never changes: ordering and fill
// are found once, factor and solve are straight loops that allocate nothing.
// Ordering: approximate minimum degree, component after component (chains and trees: no fill).
// Factorization: a row of L at a time, as in Davis, doi:10.1145/1114268.1114277.
class SparseLdlt {
 public:
  using Pair = std::array<int, 2>;

  // `pairs`: where A has off-diagonal entries, each (row, column) once, in either order.
  SparseLdlt(int n, const std::vector<Pair>& pairs);

  // A from its diagonal (n) and the entries at `pairs`, in their order. A row whose pivot is less than
  // `threshold` of its diagonal is dependent on others: its unknown is held at zero.
  void factor(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& values, double threshold = 1e-12);
  const std::vector<int>& dependent_rows() const { return dependent_; }

  void solve(Eigen::VectorXd& b);  // b ← A⁻¹b

  int fill() const;  // entries of L beyond those of A
  int components() const { return components_; }

 private:
  struct RowEntry {
    int column;    // of L
    int position;  // in values_; the column's entries before it belong to earlier rows
  };

  void order(int n, const std::vector<Pair>& pairs);
  void find_fill(const std::vector<Pair>& pairs);

  std::vector<int> old_of_new_, new_of_old_;
  std::vector<int> a_start_, a_row_, a_value_;  // A's upper triangle by columns: row, index into `values`
  std::vector<int> row_start_;                  // L by rows: pattern
  std::vector<RowEntry> row_entry_;
  std::vector<int> column_start_, column_row_;  // L by columns
  Eigen::VectorXd values_, inv_d_, work_;
  std::vector<int> dependent_;
  int components_ = 0;
};

}  // namespace taut
