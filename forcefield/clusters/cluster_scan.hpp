#pragma once

namespace taut {

// Clusters of a column that a cluster may meet, sorted by z.
struct ClusterRange {
  int begin, end;
};

// A cluster in search of partners.
struct ClusterScan {
  const double* low[3];  // bounds of all clusters, and of a vector's width more [nm]
  const double* high[3];
  const double* x;                 // 12 a cluster [nm]
  double range;                    // [nm]
  double own_low[3], own_high[3];  // bounds of the searching cluster where it meets the others [nm]
  double own_x[12];                // and its atoms
  int row_atoms;                   // 2: the cluster's first two atoms are a row, and its last two; 4: all
  int* candidates;                 // room for all clusters, and a vector's width more
  int* found[2];                   // by row: the same
  int count[2];                    // how many there are
};

// Appends the clusters with an atom within range of one of the row.
void scan_clusters(ClusterScan& scan, const ClusterRange* ranges, int count);

}  // namespace taut
