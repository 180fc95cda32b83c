#pragma once

#include <vector>

namespace taut {

// The partners of each of n things that are paired: a has partner[begin[a]] … partner[begin[a + 1] − 1].
struct Adjacency {
  std::vector<int> begin, partner;

  // pairs: a range of anything that binds to two indices [i, j].
  template <class Pairs>
  Adjacency(int n, const Pairs& pairs) : begin(n + 1, 0), partner(2 * pairs.size()) {
    for (const auto& [i, j] : pairs) ++begin[i + 1], ++begin[j + 1];
    for (int a = 0; a < n; ++a) begin[a + 1] += begin[a];
    std::vector<int> next(begin.begin(), begin.end() - 1);
    for (const auto& [i, j] : pairs) {
      partner[next[i]++] = j;
      partner[next[j]++] = i;
    }
  }
};

}  // namespace taut
