#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "forcefield/clusters/cluster_list.hpp"
#include "forcefield/clusters/rounded_positions.hpp"

namespace taut {

// Rows begin .. end of a list.
struct RowRange {
  int begin, end;
};

// What of an outer list's rows is within `range` now, and their cores, in rows of row_atoms.
struct Pruning {
  const RoundedPositions& x;
  const std::vector<std::uint8_t>& kind;  // by slot
  double range;                           // [nm]
  int row_atoms;
  const std::vector<double>&
      moved;        // by cluster: how far its atoms may be from where they were searched [nm]
  double farthest;  // of all [nm]
  double buffer;    // of the outer list [nm]

  // Of a row's shells: a pair out of range by more than both have moved stays so.
  int shells(const PairRow& row) const {
    const double of_buffer = (moved[row.first / kClusterAtoms] + farthest) / buffer;
    return std::min(1 + static_cast<int>(kShells * of_buffer), kShells);
  }
  // Adds it to `pruned`; its clusters may have room to spare at their end.
  void add(const ClusterList& list, RowRange rows, ClusterList& pruned) const;
};

}  // namespace taut
