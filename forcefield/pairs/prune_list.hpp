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

// Prunes an outer list: of its rows' j-clusters keeps the core and those within `range` now, in rows of
// row_atoms.
struct Pruning {
  const RoundedPositions& x;
  const std::vector<std::uint8_t>& kind;  // by slot
  double range;                           // [nm]
  int row_atoms;
  const std::vector<double>& moved;  // by cluster: the largest distance from the position of the search [nm]
  double farthest;                   // the largest of them [nm]
  double buffer;                     // of the outer list [nm]

  // Appends to `pruned`, whose `clusters` may end in unused room.
  void add(const ClusterList& list, RowRange rows, ClusterList& pruned) const;
};

}  // namespace taut
