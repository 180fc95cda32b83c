#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/archive.hpp"
#include "base/vectors.hpp"
#include "forcefield/pairs/cluster_list.hpp"
#include "md/box.hpp"

namespace taut {

// Atoms sorted in space into clusters of four (Páll and Hess 2013, doi:10.1016/j.cpc.2013.06.003). Space is
// cut into columns along z, as wide as the cube that holds eight atoms on average. In each column, from
// below, the lowest atom left and three of the next seven make a cluster, chosen such that the other four
// stay compact too. Only occupied columns are kept, in a hash table, so the cost is linear in the atoms
// however empty the space is. Atoms stand in slots, four to a cluster; slots left over are fillers, which
// repeat the last atom and must not interact. Atoms are wrapped into the unit cell of the box (md/box.hpp).
// Without a box, coordinates count from the first atom, and gaps wider than any pair's range are closed:
// separations within range do not change, and coordinates stay small.
class AtomClusters {
 public:
  struct Column {
    std::array<std::int64_t, 2> place;  // in the grid of columns
    int begin, end;                     // its clusters
  };
  // A column near another one, whose atoms, moved by `shift`, are near it.
  struct Neighbour {
    int begin, end;  // its clusters
    int image;       // equal for equal shifts
    Vec3 shift;      // a vector of the lattice [nm]
  };
  struct Layout {
    bool periodic;
    double range;                       // the largest distance of a listed pair, less than an edge [nm]
    std::vector<std::uint8_t> present;  // n: atoms that interact at all
    std::vector<std::uint8_t> first;    // n: atoms that come first within their cluster
  };

  explicit AtomClusters(Layout layout) : layout_(std::move(layout)) {}

  // Throws SimulationFailure for atoms too far off for the grid.
  void build(const Vectors& x, const Box& box);
  // Takes the atoms in their own order: where every pair counts there is nothing to search.
  void build_in_order(const Vectors& x);

  // Moves the atoms along with a box whose vectors have changed a little; the clusters stay as they are.
  void follow(const Box& box);

  const Box& box() const { return box_; }
  const Box& built_in() const { return built_in_; }  // the box of the last build
  int count() const { return static_cast<int>(atom_.size()) / kClusterAtoms; }
  int slots() const { return static_cast<int>(atom_.size()); }
  int atom(int slot) const { return atom_[slot]; }
  bool filler(int slot) const { return slot % kClusterAtoms > 0 && atom_[slot] == atom_[slot - 1]; }
  // What is added to an atom's position: a vector of the lattice, or the gaps that are closed [nm].
  const Vec3& offset(int slot) const { return offset_[slot]; }
  int slot_of(int atom) const { return slot_of_[atom]; }  // −1 for an atom not present

  // The largest extent of a cluster along an axis when it is built [nm].
  double widest() const { return std::max({width_[0], width_[1], tallest()}); }

  const std::vector<Column>& columns() const { return columns_; }
  // The columns within range of the column moved by `up` (−1, 0 or 1) times c, in all images along a and b.
  // Each pair of columns is found from one side only, the column itself once. Ordered by image.
  void find_neighbours(const Column& column, int up, std::vector<Neighbour>& out) const;

  // The columns' width before the last build; after loading, that build is to be repeated, and followed.
  void serialize(Archive& archive);

 private:
  using GridColumn = std::array<std::int64_t, 2>;
  struct Entry {
    double z;
    int atom;
    bool first;  // of a cluster
  };

  // Along an axis, atoms from `begin` up to the next stretch are moved by `offset` [nm].
  struct Stretch {
    double begin, offset;
  };

  double tallest() const { return 2 * layout_.range; }
  void close_gaps(const Vectors& x);
  double offset_along(int d, double x) const;
  void choose_columns(const Vectors& x);
  double occupied_volume(const Vectors& x);
  Vec3 offset_of(const Vec3& x) const;
  std::optional<GridColumn> find_grid_column(const Vec3& wrapped) const;
  void add_neighbours_of_image(const Column& column, const Vec3& steps, std::vector<Neighbour>& out) const;
  std::size_t table_entry(const GridColumn& place) const;
  void find_columns(const Vectors& x);
  void fill_columns();
  void group_into_clusters(int begin, int end);  // a column's entries
  int choose_cluster(int first, int end);
  void resize_slots(int clusters);
  void fill_slots(int column);

  Layout layout_;
  Box box_, built_in_;
  long builds_ = 0;
  std::array<double, 2> width_{};           // of a column [nm]
  std::array<std::int64_t, 2> count_{};     // of columns along the box's edges
  std::vector<int> table_;                  // hash table: indices into columns_, −1 for none
  std::vector<Column> columns_, unsorted_;  // in the order of the grid, and of their first atoms
  std::vector<int> atoms_in_column_;        // as unsorted_
  std::vector<int> entry_begin_;            // in entries_, by column, and their end
  std::vector<bool> marked_;                // by hash: cubes that hold atoms
  std::array<std::vector<Stretch>, 3> stretches_;
  std::vector<double> along_;   // the atoms' coordinates along one axis, sorted
  std::vector<int> column_of_;  // by atom, as what follows
  std::vector<Vec3> wrap_;      // the vector that moves it into the box
  std::vector<Vec3> wrapped_;   // its position then
  std::vector<std::optional<GridColumn>> grid_column_;
  std::vector<int> rank_, order_;  // places in columns_ by those in unsorted_, and the other way round
  std::vector<int> next_;          // by column: where its next atom goes in entries_
  std::vector<Entry> entries_;
  std::vector<int> atom_, slot_of_;  // by slot its atom, by atom its slot
  std::vector<Vec3> offset_;         // by slot: what is added to its atom's position [nm]
};

}  // namespace taut
