#pragma once

#include <array>
#include <vector>

#include "base/archive.hpp"
#include "base/threads.hpp"
#include "forcefield/pairs/atom_clusters.hpp"
#include "forcefield/pairs/rounded_positions.hpp"

namespace taut {

// Where atoms are, and were in the two calls before: what tells where they will be.
//
// A list made for places c with margins m misses no pair while |x − c| ≤ m for every atom. In T calls to come
// an atom goes the way
//     w = T u + T²/2 a,   u = (3x − 4x' + x'')/2,  a = x − 2x' + x''   (backward differences, by call)
// so it stays within |w|/2 of c = x + w/2, the middle of its way, but for what w misses: m = |w|/2 + e. Fast
// atoms have wide margins, slow ones narrow ones. T is such that |w|/2 is as chosen in the mean.
class AtomTracks {
 public:
  struct Aim {
    double way;    // |w|/2 in the mean [nm]
    double spare;  // e [nm]
    double reach;  // how far from where the atoms were at a search c and m together may reach [nm]

    double unknown() const { return 2 * (way + spare); }  // m of an atom that may go anywhere
  };
  struct Course {
    std::array<const double*, 3> x;  // x, x', x''
    std::array<double, 3> weight;    // w is their sum, so weighted
    double farthest;                 // |w|/2 that is believed [nm]
    double spare, unknown;           // m is |w|/2 and the one, or the other [nm]
  };

  void make_room(int clusters, Eigen::Index atoms);

  // By slot, 12 numbers a cluster: x of its four, y, z [nm].
  static std::size_t entry(int slot, int d) { return 12 * std::size_t(slot / 4) + 4 * d + slot % 4; }
  std::vector<double>& now() { return x_[0]; }
  const std::vector<double>& now() const { return x_[0]; }
  bool stand_at(const Vectors& x, const AtomClusters& clusters) const;
  void advance();                // what is now becomes before
  void forget() { known_ = 0; }  // all before

  // Into other clusters: leave() those there were, put the atoms where they are now, enter() those there are.
  void leave(const AtomClusters& clusters, const Share& share);
  void enter(const AtomClusters& clusters, const Share& share);

  // c and m of the list to come; says Σ |w|/2. Then, of all, T of the one after.
  double look_ahead(const Aim& aim, const Share& clusters, RoundedPositions& list) const;
  void adjust(double half_ways, const Aim& aim);

  // Whether every atom is within its margin. Not where one is nowhere.
  bool served(const RoundedPositions& list, const Share& clusters) const;

  void serialize(Archive& archive);

 private:
  std::array<std::vector<double>, 3> x_;
  std::array<Vectors, 2> steps_;  // by atom, between clusters
  int known_ = 0;                 // how many before
  double ahead_ = 1;              // T
};

// How far at most an atom of the clusters, within its margin of its place in `list`, is from its place in
// `searched`, infinitely where one is nowhere [nm]; and of each cluster.
double farthest(const RoundedPositions& searched, const Share& clusters, const RoundedPositions& list,
                std::vector<double>& each);

}  // namespace taut
