#pragma once

#include <vector>

#include "forcefield/cell_list.hpp"
#include "forcefield/pair_list.hpp"

namespace taut {

// How far the pairs of a list reach.
struct ListRange {
  double cutoff;  // [nm]
  double buffer;  // kept beyond it, so that a list lasts [nm]
};

// The pairs within cutoff + buffer (Verlet 1967, doi:10.1103/PhysRev.159.98), found through cells. While no
// atom has moved more than half the buffer, no pair can have come inside the cutoff unlisted.
// Cost: linear in the atoms; a box under 5/2 ranges an edge is searched pair by pair instead.
class NeighbourList {
 public:
  NeighbourList(const PairRules& rules, const Box& box, ListRange range);

  // Rebuilds if some atom moved more than half the buffer since the last build. Says whether it did.
  // Throws SimulationFailure for a position that is not finite.
  bool update(const Vectors& x);

  const PairLists& pairs() const { return lists_; }

  // The positions of the last update, each moved by whole box edges: a row's separations are
  // x_i − x_j − shift of these, already the nearest images, unless the box is too small for that.
  const Vectors& positions() const { return x_; }
  bool needs_images() const { return box_.periodic() && !in_cells_; }

  long candidates() const { return candidates_; }  // pairs whose distance the last build looked at

 private:
  bool outdated(const Vectors& x) const;
  void build_from_cells(const Vectors& x);
  void build_from_all(const Vectors& x);

  PairSorter sorter_;
  Box box_;
  ListRange range_;
  bool in_cells_;  // whether the box is wide enough for cells
  CellList cells_;
  PairLists lists_;
  Vectors x_built_;       // positions at the last build [nm]
  Vectors offset_, x_;    // whole box edges, since the last build; positions with them [nm]
  std::vector<int> row_;  // candidates of one atom
  long candidates_ = 0;
};

}  // namespace taut
