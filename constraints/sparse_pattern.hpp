#pragma once

#include <array>
#include <vector>

namespace taut {

// Where a factorization L D U without pivoting of a matrix with a symmetric pattern has entries: ordering
// and fill, found once. Ordering: approximate minimum degree, component after component (chains and trees: no
// fill). Fill: row k of L has the columns on the elimination tree's paths from A's entries in row k up to k
// (Davis 2005, doi:10.1145/1114268.1114277).
struct SparsePattern {
  using Pair = std::array<int, 2>;
  struct RowEntry {
    int column;    // of L
    int position;  // in the column-wise storage; the column's entries before it belong to earlier rows
  };

  // `pairs`: where the n × n matrix has off-diagonal entries; each unordered pair of indices once.
  SparsePattern(int n, const std::vector<Pair>& pairs);

  int size() const { return static_cast<int>(old_of_new.size()); }
  int fill() const { return static_cast<int>(column_row.size() - a_row.size()); }  // entries L adds to A's

  std::vector<int> old_of_new;  // the elimination order
  int components = 0;
  std::vector<int> a_start, a_row;  // A above the diagonal, by columns, in the new order ...
  std::vector<int> a_pair;          // ... each entry's index in `pairs` ...
  std::vector<char> a_flipped;      // ... and whether the new order turned the pair round
  std::vector<int> row_start;       // L by rows
  std::vector<RowEntry> row_entry;
  std::vector<int> column_start, column_row;  // L by columns

 private:
  void order(int n, const std::vector<Pair>& pairs);
  void find_fill(const std::vector<Pair>& pairs);
};

// The smallest index of each index's connected component.
std::vector<int> connected_components(int n, const std::vector<SparsePattern::Pair>& pairs);

}  // namespace taut
