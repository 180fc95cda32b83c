#pragma once

#include "md/vectors.hpp"

namespace taut {

// Clusters of a column that a cluster may meet, sorted by z.
struct ClusterRange {
  int begin, end;
};

// A cluster in search of partners.
struct ClusterScan {
  const float* low[3];  // bounds of all clusters, and of a vector's width more [nm]
  const float* high[3];
  double reach;                   // of bounds, margins included [nm]
  double range;                   // of atoms, without [nm]
  float own_low[3], own_high[3];  // bounds of the searching cluster where it meets the others [nm]
  const float* x;                 // RoundedPositions of all clusters
  int own;                        // the searching cluster
  Vec3 shift;                     // moves it there [nm]
  int* candidates;                // room for all clusters, and a vector's width more
  int* found;                     // the same
  int count;                      // how many there are
};

// Appends the clusters with an atom within reach of one of the searching.
void scan_clusters(ClusterScan& scan, const ClusterRange* ranges, int count);

}  // namespace taut
