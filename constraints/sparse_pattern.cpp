#include "constraints/sparse_pattern.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <numeric>

namespace taut {

std::vector<int> connected_components(int n, const std::vector<SparsePattern::Pair>& pairs) {
  std::vector<int> root(n);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int a) {
    while (root[a] != a) a = root[a] = root[root[a]];
    return a;
  };
  for (const auto& [a, b] : pairs) {
    const auto [low, high] = std::minmax({find(a), find(b)});
    root[high] = low;
  }
  for (int a = 0; a < n; ++a) root[a] = find(a);
  return root;
}

SparsePattern::SparsePattern(int n, const std::vector<Pair>& pairs) {
  order(n, pairs);
  find_fill(pairs);
}

void SparsePattern::order(int n, const std::vector<Pair>& pairs) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(n + 2 * pairs.size());
  for (int a = 0; a < n; ++a) entries.emplace_back(a, a, 1.0);
  for (const auto& [a, b] : pairs) {
    entries.emplace_back(a, b, 1.0);
    entries.emplace_back(b, a, 1.0);
  }
  Eigen::SparseMatrix<double> pattern(n, n);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  if (n > 0) Eigen::AMDOrdering<int>()(pattern, permutation);
  old_of_new.assign(permutation.indices().data(), permutation.indices().data() + permutation.size());

  const std::vector<int> component = connected_components(n, pairs);
  for (int a = 0; a < n; ++a) components += component[a] == a;
  std::stable_sort(old_of_new.begin(), old_of_new.end(),
                   [&](int a, int b) { return component[a] < component[b]; });
}

void SparsePattern::find_fill(const std::vector<Pair>& pairs) {
  const int n = size();
  std::vector<int> new_of_old(n);
  for (int p = 0; p < n; ++p) new_of_old[old_of_new[p]] = p;

  struct Above {
    int row, pair;
    bool flipped;
  };
  std::vector<std::vector<Above>> above(n);  // the entries of column k with rows i < k
  for (int e = 0; e < static_cast<int>(pairs.size()); ++e) {
    const int p = new_of_old[pairs[e][0]], q = new_of_old[pairs[e][1]];
    above[std::max(p, q)].push_back({std::min(p, q), e, p > q});
  }

  std::vector<int> parent(n, -1), seen_for(n, -1), count(n, 0);
  std::vector<std::vector<int>> rows(n);
  a_start.assign(1, 0);
  for (int k = 0; k < n; ++k) {
    seen_for[k] = k;
    for (const auto& [row, pair, flipped] : above[k]) {
      a_row.push_back(row);
      a_pair.push_back(pair);
      a_flipped.push_back(flipped);
      for (int i = row; seen_for[i] != k; i = parent[i]) {
        if (parent[i] < 0) parent[i] = k;
        seen_for[i] = k;
        rows[k].push_back(i);
      }
    }
    a_start.push_back(static_cast<int>(a_row.size()));
    std::sort(rows[k].begin(), rows[k].end());  // children before parents
    for (int i : rows[k]) ++count[i];
  }

  column_start.assign(n + 1, 0);
  std::partial_sum(count.begin(), count.end(), column_start.begin() + 1);
  column_row.resize(column_start[n]);
  std::vector<int> next(column_start.begin(), column_start.end() - 1);
  row_start.assign(1, 0);
  for (int k = 0; k < n; ++k) {
    for (int i : rows[k]) {
      row_entry.push_back({i, next[i]});
      column_row[next[i]++] = k;
    }
    row_start.push_back(static_cast<int>(row_entry.size()));
  }
}

}  // namespace taut
