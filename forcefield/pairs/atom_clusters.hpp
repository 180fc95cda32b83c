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

// Atoms sorted in space into clusters of four (Páll and Hess 2013, doi:10.1016/j.cpc.2013.06.003): columns
// along z as wide as eight atoms' cube, and from each, upwards, the lowest atom left with the three that leave the next four compact, too. Only
// occupied columns are kept, in a hash table: linear in the atoms, however empty the space is. Atoms stand in
// slots, four to a cluster; slots left over are fillers, which repeat the last atom and must not act.
// Where atoms are is counted in the brick of the box (md/box.hpp); without one, from the first of them, and
// space that is empty further than any pair reaches is left out: what is near each other keeps its
// separation, and coordinates stay small.
class AtomClusters {
 public:
  struct Column {
    std::array<std::int64_t, 2> place;  // in the grid
    int begin, end;                     // its clusters
  };
  // A column as another sees it: the other's atoms, moved by `shift`, meet it where it is.
  struct Neighbour {
    int begin, end;  // its clusters
    int image;       // equal for equal shifts
    Vec3 shift;      // whole steps of the lattice [nm]
  };
  struct Layout {
    bool periodic;
    double range;                       // how far partners can be: less than an edge [nm]
    std::vector<std::uint8_t> present;  // n: atoms that interact at all
    std::vector<std::uint8_t> first;    // n: atoms to come first within their cluster
  };

  explicit AtomClusters(Layout layout) : layout_(std::move(layout)) {}

  // Throws SimulationFailure for atoms too far off to have a place.
  void build(const Vectors& x, const Box& box);
  // The atoms in their own order: where every pair counts, there is nothing to search.
  void build_in_order(const Vectors& x);

  const Box& box() const { return box_; }  // of the last build
  int count() const { return static_cast<int>(atom_.size()) / kClusterAtoms; }
  int slots() const { return static_cast<int>(atom_.size()); }
  int atom(int slot) const { return atom_[slot]; }
  bool filler(int slot) const { return slot % kClusterAtoms > 0 && atom_[slot] == atom_[slot - 1]; }
  // What to add to the atom's position to see it among the others: whole steps of the lattice, or what is
  // left out [nm].
  const Vec3& offset(int slot) const { return offset_[slot]; }
  int slot_of(int atom) const { return slot_of_[atom]; }  // −1 for an atom not present

  // Along no axis are two atoms of a cluster further apart when it is built [nm].
  double widest() const { return std::max({width_[0], width_[1], tallest()}); }

  const std::vector<Column>& columns() const { return columns_; }
  // The columns within range of the column moved up by −1, 0 or 1 times c, and by what of a and b it takes.
  // Each pair of columns, of all images, from one side only; the column itself once. Ordered by image.
  void neighbours(const Column& column, int up, std::vector<Neighbour>& out) const;

  // The columns' width, as it was before the last build, which is to be done again.
  void serialize(Archive& archive);

 private:
  using Place = std::array<std::int64_t, 2>;
  struct Entry {
    double z;
    int atom;
    bool first;  // of a cluster
  };

  // Between gaps, along an axis: atoms from `begin` on are moved by `offset` [nm].
  struct Stretch {
    double begin, offset;
  };

  double tallest() const { return 2 * layout_.range; }
  void leave_gaps_out(const Vectors& x);
  double offset_along(int d, double x) const;
  void choose_columns(const Vectors& x);
  double crowded_volume(const Vectors& x);
  Vec3 offset_of(const Vec3& x) const;
  std::optional<Place> locate(const Vec3& wrapped) const;
  void meet(const Column& column, const Vec3& steps, std::vector<Neighbour>& out) const;
  std::size_t table_entry(const Place& place) const;
  void find_columns(const Vectors& x);
  void fill_columns();
  void bring_near(const Column& column);
  int take_near(int first, int end);
  void make_room(int clusters);
  void cut(Column& column, int cluster);

  Layout layout_;
  Box box_;
  int builds_ = 0;
  std::array<double, 2> width_{};        // of a column [nm]
  std::array<std::int64_t, 2> count_{};  // of columns along the box's edges
  std::vector<int> table_;               // hash table: indices into columns_, −1 for none
  std::vector<Column> columns_, unsorted_;
  std::vector<bool> marked_;
  std::array<std::vector<Stretch>, 3> stretches_;
  std::vector<double> along_;
  std::vector<int> column_of_;  // by atom, as what follows
  std::vector<Vec3> wrap_;      // what moves it into the box
  std::vector<Vec3> wrapped_;   // where it is then
  std::vector<std::optional<Place>> place_;
  std::vector<int> rank_, order_, next_;
  std::vector<Entry> entries_;
  std::vector<int> atom_;
  std::vector<Vec3> offset_;
  std::vector<int> slot_of_;
};

}  // namespace taut
