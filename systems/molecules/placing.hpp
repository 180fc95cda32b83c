#pragma once

#include <functional>

#include "md/box.hpp"
#include "systems/molecules/conformation.hpp"

namespace taut {

// Places copies of molecules in a box one by one, each where the previous ones leave room.
class Placing {
 public:
  // `may_overlap`: a start whose atoms are pushed apart later.
  Placing(const Box& box, double widest, Random& random, std::vector<Slab> rooms = {},
          bool may_overlap = false)
      : space_(box, widest, std::move(rooms)), random_(random), may_overlap_(may_overlap) {}

  // Places a copy at a position from `where`, which is called repeatedly; if there is no room, with smaller
  // spheres; where copies may overlap, wherever that is. Returns nothing if there is no room for the smallest, either.
  std::optional<Vectors> place_copy(const Conformations& conformations, const std::function<Vec3()>& where);

  // Adds copies at given positions, the columns of x. `each` is the number of atoms of a copy; 0 stands for
  // all.
  void add_copies(const Conformations& conformations, const Vectors& x, int each = 0);

  // Returns the numbers of those copies that fit beside everything placed so far.
  std::vector<Eigen::Index> list_fitting(const Conformations& conformations, const Vectors& x,
                                         int each) const;

 private:
  OccupiedSpace space_;
  Random& random_;
  bool may_overlap_;
};

}  // namespace taut
