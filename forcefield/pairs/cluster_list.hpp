#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/vectors.hpp"

namespace taut {

inline constexpr int kClusterAtoms = 4;

// What atoms have; a pair is summed for what both have.
enum PairKind : std::uint8_t { kHasLj = 1, kHasCharge = 2 };

// Two or four atoms that follow each other in a cluster, and the clusters they meet. Some pairs of atoms may
// not count (exclusions, pairs met from the other side): their clusters come with a mask.
struct PairRow {
  int first;                     // slot of its first atom
  int kind;                      // what its atoms have, together
  int begin, end;                // in ClusterList::clusters
  int masked_begin, masked_end;  // in ClusterList::masked
  Vec3 shift;                    // its atoms, moved by this, meet the clusters where they are [nm]
};

struct MaskedCluster {
  int cluster;
  std::uint32_t mask;  // bit 4i + j: atom i of the row and atom j of the cluster count
};

// A row of an outer list has its clusters in the order of how near they were when it was searched: a core,
// which every inner list has, and shells, each of which matters once atoms have moved so far.
inline constexpr int kShells = 6;
using ShellEnds = std::array<int, kShells + 1>;  // in ClusterList::clusters: the core's, the shells'

struct ClusterList {
  std::vector<PairRow> rows;
  std::vector<int> clusters;  // may have room to spare at its end
  std::vector<MaskedCluster> masked;
  std::vector<ShellEnds> shells;  // by row of an outer list

  void clear() {
    rows.clear();
    clusters.clear();
    masked.clear();
    shells.clear();
  }
};

}  // namespace taut
