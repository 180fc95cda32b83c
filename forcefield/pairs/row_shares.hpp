#pragma once

#include <numeric>
#include <vector>

#include "forcefield/pairs/prune_list.hpp"

namespace taut {

// Shares the rows of all threads' outer lists out again, in the order in which they were found, so that each
// thread has the same work.
class RowShares {
 public:
  struct Stretch {
    int list;
    RowRange rows;
  };

  void make_room(int threads) {
    before_.assign(threads + 1, 0);
    stretches_.resize(threads);
  }

  // Thread t's list, when it is made; then, once; then thread t's share.
  void count(int t, const ClusterList& list) {
    for (const PairRow& row : list.rows) before_[t + 1] += work(row);
  }
  void add_up() { std::partial_sum(before_.begin(), before_.end(), before_.begin()); }
  void take(int t, const std::vector<ClusterList>& lists) {
    const int threads = static_cast<int>(lists.size());
    const long all = before_.back(), begin = all * t / threads, end = all * (t + 1) / threads;
    stretches_[t].clear();
    for (int u = 0; u < threads; ++u) {
      if (before_[u + 1] <= begin || before_[u] >= end) continue;
      long before = before_[u];
      const auto pass = [&, rows = static_cast<int>(lists[u].rows.size())](int r, long limit) {
        for (; r < rows && before < limit; ++r) before += work(lists[u].rows[r]);
        return r;
      };
      const int first = pass(0, begin);
      stretches_[t].push_back({u, {first, pass(first, end)}});
    }
  }

  const std::vector<Stretch>& stretches(int t) const { return stretches_[t]; }

 private:
  static long work(const PairRow& row) { return row.end - row.begin + row.masked_end - row.masked_begin; }

  std::vector<long> before_;  // work: of the lists before each, and of all
  std::vector<std::vector<Stretch>> stretches_;
};

}  // namespace taut
