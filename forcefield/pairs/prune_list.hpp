#pragma once

#include <cstdint>
#include <vector>

#include "forcefield/pairs/cluster_list.hpp"
#include "forcefield/pairs/rounded_positions.hpp"

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
  const std::vector<double>& moved;  // by cluster: how far it may be from where it was searched [nm]
  double farthest;                   // of all [nm]
  double buffer;                     // of the outer list [nm]

  // Adds it to `pruned`; its clusters may have room to spare at their end.
  void add(const ClusterList& list, RowRange rows, ClusterList& pruned) const;
};

}  // namespace taut
