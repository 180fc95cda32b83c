#pragma once

#include <array>
#include <vector>

namespace taut {

// How a group of threads solves A λ = b of one cluster, planned on the host: A = L U by elimination without pivoting.
// Unknowns are eliminated in rounds. Those of a round are not coupled to each other, so that each thread takes one of
// them. No two threads change the same number, and each number's changes are summed in one order: bits do not depend
// on the device's schedule.
//
// The numbers of a cluster stand in one array: A's diagonal first (number k is A_kk), then its other entries with
// those that fill in, then b.
struct GroupPlan {
  std::vector<int> row, column;  // of each entry of A
  std::vector<int> rounds;       // where each round begins in `pivots`, and the end of the last
  std::vector<int> pivots;       // unknowns in the order of their elimination
  // number[target] −= Σ number[left] number[right]/A_pp, for each round in turn
  std::vector<int> target_rounds;  // where each round begins in `targets`, and the end of the last
  std::vector<int> targets;
  std::vector<int> change_start;  // where the changes of each target begin, and the end of the last
  std::vector<int> changes;       // left, p, right
  // λ_p = (b_p − Σ A_pm λ_m)/A_pp, rounds in reverse
  std::vector<int> later_start;  // for each of `pivots`, and the end of the last
  std::vector<int> later;        // the entry A_pm, m
  // Bonds of each atom: +(k + 1) where the bond ends at it, −(k + 1) where it begins.
  std::vector<int> bonds_start, bonds;

  int unknowns() const { return static_cast<int>(pivots.size()); }
  int entries() const { return static_cast<int>(row.size()); }
};

// `inv_masses` of the atoms [1/u]: an atom that never moves has 0, and couples no bonds.
GroupPlan plan_group(const std::vector<std::array<int, 2>>& bonds, const std::vector<double>& inv_masses);

}  // namespace taut
