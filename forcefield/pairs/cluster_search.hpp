#pragma once

#include <cstdint>
#include <vector>

#include "base/adjacency.hpp"
#include "base/vectors.hpp"
#include "forcefield/pairs/atom_clusters.hpp"
#include "forcefield/pairs/cluster_list.hpp"
#include "forcefield/pairs/cluster_scan.hpp"
#include "forcefield/pairs/rounded_positions.hpp"

namespace taut {

// What a search looks at.
struct SearchSpace {
  const AtomClusters& clusters;
  const Adjacency& exclusions;
  const std::vector<std::uint8_t>& kind;  // by slot
  const RoundedPositions& x;
  double range;   // [nm]
  double buffer;  // how far beyond it is looked [nm]
  double core;    // of what is as near, inner lists have all [nm]
  int row_atoms;  // of theirs

  ClusterBounds bounds = {};

  double reach(double of_buffer) const { return x.safely(range + of_buffer * buffer); }
};

// Lists the clusters within range of each other: none in range is missed. One of these a thread: it keeps its
// own room.
class ClusterSearch {
 public:
  // The rows of the clusters begin .. end. Rows of four.
  void run(const SearchSpace& space, int begin, int end, ClusterList& list);
  // The rows of row_atoms of clusters begin .. end, where every pair counts. list.clusters becomes 0, 1, 2,
  // ...
  void run_all(const SearchSpace& space, int begin_cluster, int end_cluster, ClusterList& list);

 private:
  void find_exclusions(const SearchSpace& space, int begin, int end);
  void mask_exclusions(const SearchSpace& space, int cluster);
  void meet_image(const SearchSpace& space, ClusterRange own, const Vec3& shift, ClusterList& list);
  void add_row(const SearchSpace& space, int cluster, const Vec3& shift, ClusterList& list);

  std::vector<std::uint16_t> mask_;  // by cluster: pairs with the cluster in hand that count
  std::vector<int> masked_;          // where not all do
  int begin_ = 0;                    // the first cluster
  std::vector<int> exclude_begin_;   // by cluster from there: where its own begin
  std::vector<MaskedCluster> exclude_;
  std::vector<AtomClusters::Neighbour> neighbours_;
  std::vector<ClusterRange> ranges_;
  Candidates candidates_;
  Seeker seeker_;
  Partners partners_;
};

}  // namespace taut
