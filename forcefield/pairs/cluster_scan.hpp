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

// Of clusters, number by number, and a vector's width more [nm].
struct SideBySide {
  static constexpr int kSpare = 16;
  std::array<std::vector<float>, 3 * kClusterAtoms> x;  // of their four atoms, y, z

  void make_room(int clusters);
};

struct ClusterBounds : SideBySide {
  std::array<std::vector<float>, 3> low, high;

  void make_room(int clusters);
  void find(const float* rounded, int begin, int end);  // of those clusters; rounded: RoundedPositions
};

// What clusters that follow each other may meet, where it is.
struct Candidates : SideBySide {
  std::vector<int> cluster;
  int count = 0;

  void make_room(int clusters);
};

struct Seekers {
  std::array<float, 3> low, high;  // their bounds where they meet the others [nm]
  float reach;                     // of bounds [nm]
};

// The clusters of the ranges within reach, and some between. What is below the reach of all seekers to come,
// which are higher, is left behind: the ranges begin later.
void find_candidates(const ClusterBounds& all, const Seekers& seekers, std::vector<ClusterRange>& ranges,
                     Candidates& out);

// A cluster in search of partners.
struct Seeker {
  std::array<float, 3 * kClusterAtoms> x;  // where it meets the others [nm]
  int row_atoms;
  float core2;                         // each of its rows meets a cluster of the core as near as that [nm²]
  std::array<float, kShells> shell2;   // the shells' ends [nm²]
  const MaskedCluster *exclude, *end;  // clusters to be kept apart
};

struct Partners {
  std::vector<int> cluster;  // a vector's width more
  std::vector<float> r2;     // of the nearest atoms [nm²]
  std::vector<MaskedCluster> excluded;
  std::array<int, kShells + 1> count;  // in the core and the shells

  void make_room(int clusters);
};

// Those of the candidates from `first` on that have an atom within the last shell, the core first, then the
// shells. `out` has room for as many as there are candidates, and a vector's width more.
void find_partners(const Candidates& among, int first, const Seeker& seeker, Partners& found, int* out);

}  // namespace taut
