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

// The input of a search.
struct SearchSpace {
  const AtomClusters& clusters;
  const Adjacency& exclusions;
  const std::vector<std::uint8_t>& kind;  // by slot
  const RoundedPositions& x;
  double range;   // [nm]
  double buffer;  // of the outer list [nm]
  double core;    // clusters this near are in every inner list [nm]
  int row_atoms;  // of the inner lists

  ClusterBounds bounds = {};

  double list_range(double of_buffer) const { return x.safely(range + of_buffer * buffer); }
};

// Lists all clusters within range of each other. Each thread has one of these, with scratch memory of its
// own.
class ClusterSearch {
 public:
  // Lists the rows of four atoms of the clusters begin … end − 1.
  void run(const SearchSpace& space, int begin, int end, ClusterList& list);
  // Where every pair counts: the rows of row_atoms atoms of those clusters. list.clusters becomes 0, 1, 2, …
  void run_all(const SearchSpace& space, int begin_cluster, int end_cluster, ClusterList& list);

 private:
  void find_exclusions(const SearchSpace& space, int begin, int end);
  void mask_exclusions(const SearchSpace& space, int cluster);
  void meet_image(const SearchSpace& space, ClusterRange own, const Vec3& shift, ClusterList& list);
  void add_row(const SearchSpace& space, int cluster, const Vec3& shift, ClusterList& list);
  void split_by_type(const SearchSpace& space, const PairRow& row, const ShellEnds& ends, ClusterList& list);
  static void push(const PairRow& row, const ShellEnds& ends, ClusterList& list);

  std::vector<std::uint16_t> mask_;  // by cluster: which pairs with the current i-cluster count
  std::vector<int> masked_;          // the clusters whose masks are not all ones
  int begin_ = 0;                    // the first cluster
  std::vector<int> exclude_begin_;   // by cluster from there: where its own begin
  std::vector<MaskedCluster> exclude_;
  std::vector<AtomClusters::Neighbour> neighbours_;
  std::vector<ClusterRange> ranges_;
  Candidates candidates_;
  Seeker seeker_;
  Partners partners_;
  bool many_types_ = false;     // some Lennard-Jones atoms are not of the usual type
  std::vector<int> set_aside_;  // scratch of split_by_type()
  std::vector<MaskedCluster> masked_aside_;
};

}  // namespace taut
