#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "forcefield/clusters/atom_clusters.hpp"
#include "forcefield/clusters/cluster_list.hpp"
#include "forcefield/clusters/cluster_scan.hpp"
#include "forcefield/clusters/rounded_positions.hpp"
#include "md/adjacency.hpp"
#include "md/vectors.hpp"

namespace taut {

// What a search looks at.
struct SearchSpace {
  const AtomClusters& clusters;
  const Adjacency& exclusions;
  const std::vector<std::uint8_t>& kind;  // by slot
  const RoundedPositions& x;
  double range;   // [nm]
  double margin;  // of every atom [nm]

  double reach = 0;  // a range that misses none [nm]
  // By cluster, and a vector's width more: its bounds [nm].
  std::array<std::vector<float>, 3> low = {};
  std::array<std::vector<float>, 3> high = {};

  void make_room();
  void find_bounds(int begin, int end);  // of those clusters
};

// Lists the clusters within range of each other: none in range is missed, and of those listed most hold a
// pair in range. One of these a thread: it keeps its own room.
class ClusterSearch {
 public:
  // The rows of the clusters begin .. end. Rows of four.
  void run(const SearchSpace& space, int begin, int end, ClusterList& list);
  // The rows of row_atoms of clusters begin .. end, where every pair counts. list.clusters becomes 0, 1, 2,
  // ...
  void run_all(const SearchSpace& space, int begin_cluster, int end_cluster, int row_atoms,
               ClusterList& list);

 private:
  void prepare(const SearchSpace& space);
  void meet_neighbours(const SearchSpace& space, int c, int column_begin, ClusterList& list);
  void mask_exclusions(const SearchSpace& space, int cluster);
  void add_row(const SearchSpace& space, int cluster, const Vec3& shift, bool itself, ClusterList& list);

  std::vector<std::uint16_t> mask_;  // by cluster: pairs with the cluster in hand that count
  std::vector<int> masked_;          // where not all do
  std::vector<int> found_;           // partners of the cluster in hand
  int count_ = 0;                    // how many there are
  std::vector<AtomClusters::Neighbour> neighbours_;
  std::vector<int> start_;  // by neighbour: its first cluster that can still matter
  std::vector<ClusterRange> ranges_;
  std::vector<int> candidates_;
};

}  // namespace taut
