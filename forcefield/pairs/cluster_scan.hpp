#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "forcefield/pairs/cluster_list.hpp"

namespace taut {

// Clusters of a column, sorted by z.
struct ClusterRange {
  int begin, end;
};

// Coordinates of clusters, one array a coordinate, each with room for a vector more [nm].
struct SideBySide {
  static constexpr int kSpare = 16;
  std::array<std::vector<float>, 3 * kClusterAtoms> x;  // x of the four atoms, then y, then z

  void make_room(int clusters);
};

struct ClusterBounds : SideBySide {
  std::array<std::vector<float>, 3> low, high;

  void make_room(int clusters);
  void find(const float* rounded, int begin, int end);  // of those clusters; rounded: RoundedPositions
};

// Possible j-clusters of a few consecutive i-clusters.
struct Candidates : SideBySide {
  std::vector<int> cluster;
  int count = 0;

  void make_room(int clusters);
};

// The bounding box of a few consecutive i-clusters.
struct Seekers {
  std::array<float, 3> low, high;  // periodic shift included [nm]
  float range;                     // bounds further apart than this hold no pair [nm]
};

// Lists the clusters of `ranges` whose bounds are within range, and some between them. i-clusters come in the
// order of z: clusters too low for these are too low for all after them, so the ranges are shortened at their
// beginning.
void find_candidates(const ClusterBounds& all, const Seekers& seekers, std::vector<ClusterRange>& ranges,
                     Candidates& out);

// An i-cluster whose j-clusters are searched.
struct Seeker {
  std::array<float, 3 * kClusterAtoms> x;  // periodic shift included [nm]
  int row_atoms;
  float
      core2;  // the cluster, or each half of it where rows are shorter, has an atom this near to a cluster of the core [nm²]
  std::array<float, kShells> shell2;   // the shells' ends [nm²]
  const MaskedCluster *exclude, *end;  // clusters with exclusion masks
};

// The j-clusters of an i-cluster.
struct Partners {
  std::vector<int> cluster;             // a vector's width more
  std::vector<float> r2;                // of the nearest atoms [nm²]
  std::vector<MaskedCluster> excluded;  // those of them with exclusion masks
  std::array<int, kShells + 1> count;   // in the core and the shells

  void make_room(int clusters);
};

// Writes to `out` the candidates from `first` on that have an atom within the last shell: the core first,
// then shell by shell. `out` needs room for all candidates and a vector more.
void find_partners(const Candidates& among, int first, const Seeker& seeker, Partners& found, int* out);

}  // namespace taut
