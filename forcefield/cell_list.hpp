#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "md/box.hpp"
#include "md/vectors.hpp"

namespace taut {

// Atoms sorted into the cells of a grid, so that an atom's partners within `range` are all in its own cell
// or in the cells nearby. Only occupied cells are kept, in a hash table: time and memory are linear in the
// atoms, however empty the space is. Inside a cell atoms stand in slots next to each other.
class CellList {
 public:
  struct Slots {
    int begin, end;
    int image;   // 0: none of the box's; equal for equal shifts
    Vec3 shift;  // add to the positions of these slots to see them from the cell asked about [nm]
  };

  // Whether the box is wide enough for cells: every pair of cells is met once only from 3 cells an edge on.
  static bool fits(const Box& box, double range);

  // Throws SimulationFailure for atoms too far off to have a cell.
  void build(const Vectors& x, const Box& box, double range);

  int cells() const { return static_cast<int>(keys_.size()); }
  Slots slots(int cell) const { return {begin_[cell], begin_[cell + 1], 0, Vec3::Zero()}; }
  // The occupied cells nearby, each pair of cells from one side only, ordered by image. Valid until the
  // next call.
  const std::vector<Slots>& neighbours(int cell);

  int atom(int slot) const { return atom_[slot]; }
  const int* atoms() const { return atom_.data(); }
  const Vectors& positions() const { return position_; }  // by slot, wrapped into the box [nm]
  const Vectors& offsets() const { return offset_; }      // by atom: what wrapped it, whole box edges [nm]

 private:
  using Key = std::array<std::int64_t, 3>;  // a cell's place in the grid

  void lay_grid(const Vectors& x, const Box& box, double range);
  Key locate(int a, const Vec3& x, Vec3& offset) const;
  std::size_t entry(const Key& key) const;  // where in table_ the key is, or would go

  Box box_;
  int reach_ = 1;                    // how many cells out partners can be
  Vec3 cell_edge_;                   // [nm], at least range/reach
  Key count_;                        // cells along each edge of the box
  std::vector<Key> offsets_;         // half of the cells within reach
  std::vector<Key> keys_;            // of the occupied cells
  std::vector<int> table_;           // hash table: indices into keys_, −1 for none
  std::vector<int> begin_, next_;    // cells + 1: first slot of each; first free one while sorting
  std::vector<int> cell_of_, atom_;  // n: by atom; by slot
  Vectors offset_, position_;        // by atom; by slot [nm]
  std::vector<Slots> neighbours_;
};

}  // namespace taut
