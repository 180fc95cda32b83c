#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/errors.hpp"
#include "base/vectors.hpp"

namespace taut {

inline constexpr int kClusterAtoms = 4;

// Where an array by slot has number d of an atom: a cluster has so many rows, each of one number of its four atoms, which
// may stand there in several copies.
constexpr std::ptrdiff_t entry(std::ptrdiff_t slot, std::ptrdiff_t d, int rows = 3, int copies = 1) {
  return kClusterAtoms * copies * (rows * (slot / kClusterAtoms) + d) + slot % kClusterAtoms;
}

// The interactions that an atom has; a pair is summed for those that both atoms have. kHasOtherType marks Lennard-Jones
// atoms that are not of the usual type, which is the most frequent one.
enum PairKind : std::uint8_t { kHasLj = 1, kHasCharge = 2, kHasOtherType = 4 };

// An i-cluster, or half of one, and its j-clusters: two or four consecutive atoms of a cluster and the
// clusters within range of them. A j-cluster in which some pairs do not count (exclusions, pairs that another
// row has) comes with an exclusion mask.
struct PairRow {
  int first;       // slot of its first atom
  int kind;        // the union of its atoms' PairKind; kHasOtherType also for a j-cluster's atom
  int begin, end;  // in ClusterList::clusters
  int masked_begin, masked_end;  // in ClusterList::masked
  Vec3 shift;                    // periodic image: added to the positions of its atoms [nm]
};

struct MaskedCluster {
  int cluster;
  std::uint32_t mask;  // bit 4i + j: atom i of the row and atom j of the cluster count
};

// A row of an outer list has its j-clusters in the order of their distance when it was searched: first a
// core, which every inner list contains, then shells, each of which is needed once atoms have moved so far.
inline constexpr int kShells = 6;
using ShellEnds = std::array<int, kShells + 1>;  // in ClusterList::clusters: the core's, the shells'

struct ClusterList {
  std::vector<PairRow> rows;
  std::vector<int> clusters;  // may have room to spare at its end
  std::vector<MaskedCluster> masked;
  std::vector<ShellEnds> shells;  // by row of an outer list

  // Room for so many j-clusters. Throws InputError for more than rows can number.
  void make_room(std::size_t count) {
    if (count > static_cast<std::size_t>(std::numeric_limits<int>::max()))
      throw InputError(
          "the pair list of a thread is longer than taut can number (2^31 entries): take a shorter cutoff or "
          "more "
          "threads");
    if (clusters.size() < count) clusters.resize(count);
  }
  void clear() {
    rows.clear();
    clusters.clear();
    masked.clear();
    shells.clear();
  }
};

}  // namespace taut
