#pragma once

#include <cstdint>
#include <vector>

#include "forcefield/clusters/cluster_list.hpp"
#include "forcefield/clusters/rounded_positions.hpp"

namespace taut {

// Rows begin .. end of a list.
struct RowRange {
  int begin, end;
};

// What of a list of clusters' rows is within `range` now, in rows of row_atoms.
struct Pruning {
  const RoundedPositions& x;
  const std::vector<std::uint8_t>& kind;  // by slot
  double range;                           // [nm]
  int row_atoms;

  // Adds it to `pruned`; its clusters may have room to spare at their end.
  void add(const ClusterList& list, RowRange rows, ClusterList& pruned) const;
};

}  // namespace taut
