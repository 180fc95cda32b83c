#include "constraints/elimination.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <set>

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

  const auto rank = [&](int k) { return std::tuple(stage[k], left[k].size(), k); };
  std::set<std::tuple<Stage, std::size_t, int>> waiting;
  for (int k = 0; k < n; ++k) waiting.insert(rank(k));
  const auto take = [&](int k) {
    order.push_back(k);
    waiting.erase(rank(k));
    for (int p : left[k]) {
      waiting.erase(rank(p));
      std::vector<int> merged;
      std::ranges::set_union(left[p], left[k], std::back_inserter(merged));
      std::erase_if(merged, [&](int q) { return q == k || q == p; });
      left[p] = std::move(merged);
      waiting.insert(rank(p));
    }
  };
  if (by == Order::kMinimumDegree) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int k = 0; k < n; ++k) entries.emplace_back(k, k, 1.0);
    for (const auto& [k, l] : tied) {
      entries.emplace_back(k, l, 1.0);
      entries.emplace_back(l, k, 1.0);
    }
    Eigen::SparseMatrix<double> pattern(n, n);
    pattern.setFromTriplets(entries.begin(), entries.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
    if (n > 0) Eigen::AMDOrdering<int>()(pattern, permutation);
    for (int k : permutation.indices()) take(k);
  }
  while (!waiting.empty()) {
    std::vector<int> round;
    const auto [now, least, first] = *waiting.begin();
    for (auto w = waiting.begin(); w != waiting.end() && std::get<0>(*w) == now && std::get<1>(*w) == least;
         ++w)
      round.push_back(std::get<2>(*w));
    std::set<int> touched;
    for (int k : round) {
      if (touched.contains(k)) continue;
      touched.insert(left[k].begin(), left[k].end());
      take(k);
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
    signed_inv_mass[entry(last, first)] = couplings.signed_inv_mass[e];
  }
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
