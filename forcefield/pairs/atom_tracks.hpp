#pragma once

#include <array>
#include <vector>

#include "base/archive.hpp"
#include "base/threads.hpp"
#include "forcefield/pairs/atom_clusters.hpp"
#include "forcefield/pairs/rounded_positions.hpp"

namespace taut {

// The positions of the atoms now and in the two calls before, from which their motion is extrapolated.
//
// A pair list made for positions c with margins m misses no pair while |x − c| ≤ m for every atom. In the
// next T calls an atom moves by about
//     w = T u + T²/2 a,   u = (3x − 4x' + x'')/2,  a = x − 2x' + x''   (backward differences, per call)
// so it stays within |w|/2 of c = x + w/2, the middle of its path, but for the error of w: m = |w|/2 + e.
// Fast atoms get wide margins and slow ones narrow ones. T is adjusted so that the mean of |w|/2 is as
// chosen.
class AtomTracks {
 public:
  struct Aim {
    double way;               // |w|/2 in the mean [nm]
    double spare;             // e, added for the error of the extrapolation [nm]
    double most_from_search;  // |c − position at the last search| + m may be at most this [nm]

    double unknown() const { return 2 * (way + spare); }  // m of an atom that may go anywhere
  };
  struct Course {
    std::array<const double*, 3> x;  // x, x', x''
    std::array<double, 3> weight;    // w is their sum, so weighted
    double farthest;                 // a larger |w|/2 is not trusted [nm]
    double spare, unknown;           // m = |w|/2 + spare; m = unknown where w is not trusted [nm]
  };

  void make_room(int clusters, Eigen::Index atoms);

  // By slot: x, y, z [nm] at entry(slot, d).
  std::vector<double>& now() { return x_[0]; }
  const std::vector<double>& now() const { return x_[0]; }
  bool are_at(const Vectors& x, const AtomClusters& clusters) const;
  void advance();                // shifts the history by one call
  void forget() { known_ = 0; }  // drops the history

  // Moves the history along with the box: x becomes map · x.
  void follow(const Eigen::Matrix3d& map, const Share& clusters);

  // To change clusters: leave() stores the history by atom, the caller writes now(), enter() restores it by
  // slot.
  void leave(const AtomClusters& clusters, const Share& share);
  void enter(const AtomClusters& clusters, const Share& share);

  // Writes c and m of the next list and returns Σ |w|/2. adjust() then chooses T for the list after it.
  double look_ahead(const Aim& aim, const Share& clusters, RoundedPositions& list) const;
  void adjust(double half_ways, const Aim& aim);

  // True while every atom is inside its margin; false for NaN.
  bool covers_all(const RoundedPositions& list, const Share& clusters) const;

  void serialize(Archive& archive);

 private:
  std::array<std::vector<double>, 3> x_;
  std::array<Vectors, 2> steps_;  // by atom, between clusters
  int known_ = 0;                 // calls in the history
  double ahead_ = 1;              // T
};

// The largest distance that an atom of the clusters, inside its margin about its position in `list`, can have
// from its position in `searched` [nm]; infinite for NaN. `each` gets the largest of each cluster.
double farthest(const RoundedPositions& searched, const Share& clusters, const RoundedPositions& list,
                std::vector<double>& each);

}  // namespace taut
