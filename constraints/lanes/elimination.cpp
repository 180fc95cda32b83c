#include "constraints/lanes/elimination.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <set>

namespace taut {
namespace {

// Couplings of bonds that share an atom: neighbours[k][l] = ±1/m.
std::vector<std::map<int, double>> couplings_of(const ClusterShape& shape) {
  std::vector<std::vector<int>> bonds_at(shape.atoms());
  for (int k = 0; k < shape.bond_count(); ++k) {
    bonds_at[shape.bonds[k].i].push_back(k);
    bonds_at[shape.bonds[k].j].push_back(k);
  }
  std::vector<std::map<int, double>> coupling(shape.bond_count());
  for (int a = 0; a < shape.atoms(); ++a)
    for (int k : bonds_at[a])
      for (int l : bonds_at[a]) {
        const bool same_end = (shape.bonds[k].i == a) == (shape.bonds[l].i == a);
        if (k != l) coupling[k][l] = same_end ? shape.inv_mass[a] : -shape.inv_mass[a];
      }
  return coupling;
}

// The bonds at the ends of a piece: those between it and its neighbours, and those beyond.
std::vector<int> separators(const ClusterShape& shape) {
  std::vector<int> bonds;
  if (shape.left > 0) bonds.push_back(1);
  if (shape.right > 0) bonds.push_back(shape.bond_count() - 2);
  return bonds;
}
std::vector<int> foreign_bonds(const ClusterShape& shape) {
  std::vector<int> bonds;
  if (shape.left > 0) bonds.push_back(0);
  if (shape.right > 0) bonds.push_back(shape.bond_count() - 1);
  return bonds;
}

}  // namespace

Elimination::Elimination(const ClusterShape& shape) {
  const int n = shape.bond_count();
  const auto coupling = couplings_of(shape);
  std::vector<std::set<int>> left(n);  // neighbours not yet eliminated, fill included
  for (int k = 0; k < n; ++k)
    for (const auto& [l, s] : coupling[k]) left[k].insert(l);

  std::vector<int> place(n, -1);
  std::vector<std::vector<int>> column;  // the neighbours each unknown had when it went
  const auto take = [&](int k) {
    place[k] = static_cast<int>(order.size());
    order.push_back(k);
    column.emplace_back(left[k].begin(), left[k].end());
    for (int p : column.back()) {
      left[p].erase(k);
      for (int q : column.back())
        if (q != p) left[p].insert(q);
    }
  };
  for (int k : foreign_bonds(shape))
    for (int l : std::set<int>(left[k])) {
      left[k].erase(l);
      left[l].erase(k);
    }
  std::vector<int> waiting(n - shape.left - shape.right);
  std::iota(waiting.begin(), waiting.end(), shape.left);
  while (!waiting.empty()) {
    std::size_t least = std::numeric_limits<std::size_t>::max();
    for (int k : waiting) least = std::min(least, left[k].size());
    std::set<int> touched;
    for (int k : waiting) {
      if (left[k].size() != least || touched.contains(k)) continue;
      touched.insert(left[k].begin(), left[k].end());
      take(k);
    }
    std::erase_if(waiting, [&](int k) { return place[k] >= 0; });
  }
  eliminated = size();
  for (int k : separators(shape)) take(k);
  solved = size();
  for (int k : foreign_bonds(shape)) take(k);

  std::map<std::pair<int, int>, int> entry;  // (row, column)
  column_start.push_back(0);
  for (int k = 0; k < n; ++k) {
    for (int& p : column[k]) p = place[p];
    std::sort(column[k].begin(), column[k].end());
    for (int p : column[k]) {
      entry[{p, k}] = entries();
      row.push_back(p);
      const auto found = coupling[order[k]].find(order[p]);
      signed_inv_mass.push_back(found == coupling[order[k]].end() ? 0.0 : found->second);
    }
    column_start.push_back(entries());
  }
  for (int k = 0; k < n; ++k)
    for (std::size_t p = 0; p < column[k].size(); ++p)
      for (std::size_t q = p + 1; q < column[k].size(); ++q)
        update.push_back(entry.at({column[k][q], column[k][p]}));
}

Elimination Elimination::none(const ClusterShape& shape) {
  Elimination plan;
  plan.order.resize(shape.bond_count());
  std::iota(plan.order.begin(), plan.order.end(), 0);
  plan.column_start.assign(shape.bond_count() + 1, 0);
  plan.eliminated = plan.solved = plan.size();
  return plan;
}

}  // namespace taut
