#include "constraints/elimination.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <utility>

namespace taut {

// Finds the order. Returns, for each unknown, the unknowns that it is coupled to when it is eliminated, fill
// included.
std::vector<std::vector<int>> Elimination::find_order(const Couplings& couplings,
                                                      const std::vector<Stage>& stage, Order by) {
  const int n = couplings.bond_count();
  std::vector<std::vector<int>> left(n);  // neighbours that are not eliminated yet, in ascending order
  std::vector<IndexPair> tied;
  for (const auto& [k, l] : couplings.pairs) {
    if (stage[k] == kApart || stage[l] == kApart) continue;
    left[k].push_back(l);
    left[l].push_back(k);
    tied.push_back({k, l});
  }
  for (auto& neighbours : left) {
    std::ranges::sort(neighbours);
    neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
  }

  std::vector<bool> taken(n);
  std::vector<std::vector<int>>
      waiting;  // by degree; those that have another degree now or are taken count no more
  Stage now = kEliminated;
  const auto wait = [&](int k) {
    if (stage[k] != now) return;
    if (waiting.size() <= left[k].size()) waiting.resize(left[k].size() + 1);
    waiting[left[k].size()].push_back(k);
  };
  std::vector<int> merged;
  const auto take = [&](int k) {
    order.push_back(k);
    taken[k] = true;
    for (int p : left[k]) {
      merged.clear();
      std::ranges::set_union(left[p], left[k], std::back_inserter(merged));
      std::erase_if(merged, [&](int q) { return q == k || q == p; });
      left[p] = merged;
      if (by == Order::kRounds) wait(p);
    }
  };
  // The unknowns of the stage that have the smallest degree now, in ascending order; none: it is through.
  const auto least_coupled = [&] {
    for (std::size_t degree = 0; degree < waiting.size(); ++degree) {
      std::vector<int> round = std::exchange(waiting[degree], {});
      std::erase_if(round, [&](int k) { return taken[k] || left[k].size() != degree; });
      std::ranges::sort(round);
      round.erase(std::unique(round.begin(), round.end()), round.end());
      if (!round.empty()) return round;
    }
    return std::vector<int>{};
  };
  if (by == Order::kMinimumDegree) {
    std::vector<int> ends;  // of chains and branches: nothing else can be eliminated at less cost
    for (int end = 0; end < n; ++end) {
      ends.assign(1, end);
      while (!ends.empty()) {
        const int k = ends.back();
        ends.pop_back();
        if (taken[k] || left[k].size() > 1) continue;
        take(k);
        ends.insert(ends.end(), left[k].begin(), left[k].end());
      }
    }
  }
  if (by == Order::kMinimumDegree && std::ssize(order) < n) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int k = 0; k < n; ++k) entries.emplace_back(k, k, 1.0);
    for (const auto& [k, l] : tied) {
      entries.emplace_back(k, l, 1.0);
      entries.emplace_back(l, k, 1.0);
    }
    Eigen::SparseMatrix<double> pattern(n, n);
    pattern.setFromTriplets(entries.begin(), entries.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
    Eigen::AMDOrdering<int>()(pattern, permutation);
    for (int k : permutation.indices())
      if (!taken[k]) take(k);
  }
  if (by == Order::kRounds) {
    std::vector<int> touched(n, -1);  // in which round
    int rounds = 0;
    for (now = kEliminated; now <= kApart; now = static_cast<Stage>(now + 1)) {
      for (int k = 0; k < n; ++k) wait(k);
      for (std::vector<int> round = least_coupled(); !round.empty(); round = least_coupled(), ++rounds)
        for (int k : round) {
          if (touched[k] == rounds) continue;
          for (int p : left[k]) touched[p] = rounds;
          take(k);
        }
    }
  }
  const std::vector<int> cluster = connected_components(n, tied);
  std::ranges::stable_sort(order, {}, [&](int k) { return std::pair(stage[k], cluster[k]); });
  return left;
}

Elimination::Elimination(const Couplings& couplings, std::vector<Stage> stage, Order by) {
  const int n = couplings.bond_count();
  stage.resize(n, kEliminated);
  eliminated = static_cast<int>(std::ranges::count(stage, kEliminated));
  solved = n - static_cast<int>(std::ranges::count(stage, kApart));
  const std::vector<std::vector<int>> column = find_order(couplings, stage, by);

  std::vector<int> place(n);
  for (int k = 0; k < n; ++k) place[order[k]] = k;
  column_start.push_back(0);
  for (int k : order) {
    for (int p : column[k]) row.push_back(place[p]);
    std::sort(row.begin() + column_start.back(), row.end());
    column_start.push_back(entries());
  }
  const auto entry = [&](std::ptrdiff_t q, std::ptrdiff_t k) {
    const auto begin = row.begin() + column_start[k], end = row.begin() + column_start[k + 1];
    return std::lower_bound(begin, end, q) - row.begin();
  };
  signed_inv_mass.assign(entries(), 0.0);
  for (std::size_t e = 0; e < couplings.pairs.size(); ++e) {
    const auto [k, l] = couplings.pairs[e];
    if (stage[k] == kApart || stage[l] == kApart) continue;
    const auto [first, last] = std::minmax(place[k], place[l]);
    signed_inv_mass[entry(last, first)] += couplings.signed_inv_mass[e];
  }
  std::size_t updates = 0;  // many where rings fill a net: no room for growth besides
  for (int k = 0; k < n; ++k) {
    const auto below = static_cast<std::size_t>(column_start[k + 1] - column_start[k]);
    if (below > 0) updates += below * (below - 1) / 2;
  }
  update.reserve(updates);
  for (int k = 0; k < n; ++k)
    for (int p = column_start[k]; p < column_start[k + 1]; ++p)
      for (int q = p + 1; q < column_start[k + 1]; ++q) update.push_back(entry(row[q], row[p]));
}

// The last unknown of each set of coupled bonds has no row below it.
int Elimination::clusters() const {
  int count = 0;
  for (int k = 0; k < size(); ++k) count += column_start[k] == column_start[k + 1];
  return count;
}

}  // namespace taut
