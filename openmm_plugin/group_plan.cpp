#include "openmm_plugin/group_plan.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>

namespace taut {
namespace {

using Coupled =
    std::vector<std::set<int>>;  // for each unknown, those that it is coupled to and that are left

Coupled coupled_bonds(const GroupPlan& plan, const std::vector<std::array<int, 2>>& bonds,
                      const std::vector<double>& inv_masses) {
  Coupled coupled(bonds.size());
  for (std::size_t i = 0; i < inv_masses.size(); ++i) {
    if (inv_masses[i] == 0) continue;
    const auto begin = plan.bonds.begin() + plan.bonds_start[i],
               end = plan.bonds.begin() + plan.bonds_start[i + 1];
    for (auto k = begin; k != end; ++k)
      for (auto l = begin; l != end; ++l)
        if (k != l) coupled[std::abs(*k) - 1].insert(std::abs(*l) - 1);
  }
  return coupled;
}

// Unknowns of small degree, none of which is coupled to another of them. A degree of two more than the least adds
// little fill, and lets a chain lose every second bond in a round: DHFR with all bonds takes 14 rounds, where the least
// degree alone, which eats chains from their ends, takes 81.
std::vector<int> find_round(const Coupled& coupled, const std::set<int>& left) {
  std::size_t least = left.size();
  for (const int k : left) least = std::min(least, coupled[k].size());
  std::vector<int> round;
  std::set<int> beside;
  for (const int k : left) {
    if (coupled[k].size() > least + 2 || beside.count(k) > 0) continue;
    round.push_back(k);
    beside.insert(coupled[k].begin(), coupled[k].end());
  }
  return round;
}

void list_bonds_of_atoms(GroupPlan& plan, const std::vector<std::array<int, 2>>& bonds, int atoms) {
  std::vector<std::vector<int>> at(atoms);
  for (int k = 0; k < static_cast<int>(bonds.size()); ++k) {
    at[bonds[k][0]].push_back(-(k + 1));
    at[bonds[k][1]].push_back(k + 1);
  }
  plan.bonds_start.push_back(0);
  for (const std::vector<int>& of_atom : at) {
    plan.bonds.insert(plan.bonds.end(), of_atom.begin(), of_atom.end());
    plan.bonds_start.push_back(static_cast<int>(plan.bonds.size()));
  }
}

}  // namespace

GroupPlan plan_group(const std::vector<std::array<int, 2>>& bonds, const std::vector<double>& inv_masses) {
  GroupPlan plan;
  const int n = static_cast<int>(bonds.size());
  list_bonds_of_atoms(plan, bonds, static_cast<int>(inv_masses.size()));
  Coupled coupled = coupled_bonds(plan, bonds, inv_masses);

  std::map<std::array<int, 2>, int> number;
  const auto entry = [&](int k, int l) {
    const auto [found, fresh] = number.try_emplace({k, l}, plan.entries());
    if (fresh) {
      plan.row.push_back(k);
      plan.column.push_back(l);
    }
    return found->second;
  };
  for (int k = 0; k < n; ++k) entry(k, k);
  for (int k = 0; k < n; ++k)
    for (const int l : coupled[k]) entry(k, l);

  const int kRightHandSide = n;  // as a column
  struct Change {
    int left, pivot, right_row, right_column;
  };
  std::vector<std::map<std::array<int, 2>, std::vector<Change>>>
      of_rounds;  // by row and column of the target
  std::set<int> left;
  for (int k = 0; k < n; ++k) left.insert(left.end(), k);
  plan.rounds.push_back(0);
  plan.later_start.push_back(0);
  while (!left.empty()) {
    auto& changes = of_rounds.emplace_back();
    for (const int p : find_round(coupled, left)) {
      plan.pivots.push_back(p);
      left.erase(p);
      for (const int l : coupled[p]) {
        plan.later.insert(plan.later.end(), {entry(p, l), l});
        for (const int m : coupled[p]) {
          entry(l, m);
          changes[{l, m}].push_back({entry(l, p), p, p, m});
          if (l != m) coupled[l].insert(m);
        }
        changes[{l, kRightHandSide}].push_back({entry(l, p), p, p, kRightHandSide});
        coupled[l].erase(p);
      }
      plan.later_start.push_back(static_cast<int>(plan.later.size()) / 2);
    }
    plan.rounds.push_back(plan.unknowns());
  }

  const auto place = [&](int row, int column) {
    return column == kRightHandSide ? plan.entries() + row : entry(row, column);
  };
  plan.target_rounds.push_back(0);
  plan.change_start.push_back(0);
  for (const auto& changes : of_rounds) {
    for (const auto& [target, all] : changes) {
      plan.targets.push_back(place(target[0], target[1]));
      for (const Change& change : all)
        plan.changes.insert(plan.changes.end(),
                            {change.left, change.pivot, place(change.right_row, change.right_column)});
      plan.change_start.push_back(static_cast<int>(plan.changes.size()) / 3);
    }
    plan.target_rounds.push_back(static_cast<int>(plan.targets.size()));
  }
  return plan;
}

}  // namespace taut
