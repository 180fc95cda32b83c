#include "forcefield/clusters/cluster_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "forcefield/clusters/cluster_scan.hpp"

namespace taut {
namespace {

constexpr int kWidest = 16;  // floats a vector
constexpr std::uint16_t kAll = 0xFFFF;

// Pairs of a cluster with itself are met once: i < j. Its fillers stand where another atom stands, and must
// not meet it.
std::uint16_t met_once(const AtomClusters& clusters, int cluster) {
  unsigned mask = 0;
  for (int j = 1; j < kClusterAtoms && !clusters.filler(kClusterAtoms * cluster + j); ++j)
    for (int i = 0; i < j; ++i) mask |= 1u << (4 * i + j);
  return static_cast<std::uint16_t>(mask);
}

}  // namespace

void SearchSpace::make_room() {
  reach = x.safely(range + 2 * margin);
  for (auto* bounds : {&low, &high})
    for (auto& along : *bounds) {
      along.resize(clusters.count() + kWidest);
      std::fill_n(along.end() - kWidest, kWidest, std::numeric_limits<float>::max());
    }
}

void SearchSpace::find_bounds(int begin, int end) {
  for (int d = 0; d < 3; ++d)
    for (int c = begin; c < end; ++c) {
      const float* p = x.x.data() + 16 * c + 4 * d;
      low[d][c] = std::min({p[0], p[1], p[2], p[3]});
      high[d][c] = std::max({p[0], p[1], p[2], p[3]});
    }
}

void ClusterSearch::prepare(const SearchSpace& space) {
  const int n = space.clusters.count();
  mask_.assign(n, kAll);
  masked_.clear();
  found_.resize(n + kWidest);
  candidates_.resize(n + kWidest);
}

// Bits of pairs that do not count, in the clusters where the partners are.
void ClusterSearch::mask_exclusions(const SearchSpace& space, int cluster) {
  const auto& [begin, partner] = space.exclusions;
  for (const int j : masked_) mask_[j] = kAll;
  masked_.clear();
  for (int i = 0; i < kClusterAtoms; ++i) {
    const int slot = kClusterAtoms * cluster + i, a = space.clusters.atom(slot);
    for (int e = begin[a]; e < begin[a + 1]; ++e) {
      const int other = space.clusters.slot_of(partner[e]);
      if (other < 0) continue;
      mask_[other / kClusterAtoms] &= std::uint16_t(~(1u << (4 * i + other % kClusterAtoms)));
      masked_.push_back(other / kClusterAtoms);
    }
  }
}

// `itself`: the cluster meets itself too, each pair of its atoms once.
void ClusterSearch::add_row(const SearchSpace& space, int cluster, const Vec3& shift, bool itself,
                            ClusterList& list) {
  PairRow row{};
  row.first = kClusterAtoms * cluster;
  row.shift = shift;
  for (int i = 0; i < kClusterAtoms; ++i) row.kind |= space.kind[row.first + i];
  row.begin = static_cast<int>(list.clusters.size());
  row.masked_begin = static_cast<int>(list.masked.size());
  const unsigned own = itself ? unsigned(mask_[cluster] & met_once(space.clusters, cluster)) : 0u;
  if (own != 0) list.masked.push_back({cluster, own});
  list.clusters.resize(row.begin + count_);
  int* next = list.clusters.data() + row.begin;
  for (int k = 0; k < count_; ++k) {
    const int j = found_[k];
    *next = j;
    if (mask_[j] == kAll) [[likely]]
      ++next;
    else if (mask_[j] != 0)
      list.masked.push_back({j, mask_[j]});
  }
  row.end = static_cast<int>(next - list.clusters.data());
  list.clusters.resize(row.end);
  row.masked_end = static_cast<int>(list.masked.size());
  if (row.end > row.begin || row.masked_end > row.masked_begin) list.rows.push_back(row);
}

void ClusterSearch::run(const SearchSpace& space, int begin, int end, ClusterList& list) {
  list.clear();
  prepare(space);
  const double height = space.clusters.box().edge[2];
  const int images = height > 0 ? 1 : 0;  // along z: the column one box down, where it is, one box up
  const auto& columns = space.clusters.columns();
  auto own = std::partition_point(columns.begin(), columns.end(),
                                  [&](const AtomClusters::Column& c) { return c.end <= begin; });
  for (; own != columns.end() && own->begin < end; ++own)
    for (int image = -images; image <= images; ++image) {
      space.clusters.neighbours(*own, image, neighbours_);
      start_.clear();
      for (const auto& n : neighbours_) start_.push_back(n.begin - 1);
      for (int c = std::max(begin, own->begin); c < std::min(end, own->end); ++c) {
        if (image < 0 && space.high[2][c] - height < -space.reach) continue;
        if (image > 0 && space.low[2][c] > space.reach) continue;
        mask_exclusions(space, c);
        meet_neighbours(space, c, own->begin, list);
      }
    }
}

// Of cluster c, of the column that begins with column_begin. What is below the reach of all clusters to come
// is left behind at two clusters a turn, without branches, which would often be guessed wrong; what is not
// yet is looked at in vain.
void ClusterSearch::meet_neighbours(const SearchSpace& space, int c, int column_begin, ClusterList& list) {
  ClusterScan scan;
  for (int d = 0; d < 3; ++d) {
    scan.low[d] = space.low[d].data();
    scan.high[d] = space.high[d].data();
  }
  scan.reach = space.reach;
  scan.range = space.x.safely(space.range);
  scan.x = space.x.x.data();
  scan.own = c;
  scan.candidates = candidates_.data();
  scan.found = found_.data();
  const float* high = space.high[2].data();
  for (std::size_t n = 0; n < neighbours_.size();) {
    const int image = neighbours_[n].image;
    scan.shift = neighbours_[n].shift;
    for (int d = 0; d < 3; ++d) {
      scan.own_low[d] = static_cast<float>(space.low[d][c] + scan.shift[d]);
      scan.own_high[d] = static_cast<float>(space.high[d][c] + scan.shift[d]);
    }
    const auto lowest = static_cast<float>(space.low[2][c] + scan.shift[2] - space.reach);
    const bool unmoved = scan.shift.isZero(0);
    bool itself = false;
    ranges_.clear();
    for (; n < neighbours_.size() && neighbours_[n].image == image; ++n) {
      const auto& other = neighbours_[n];
      int& start = start_[n];
      if (start < other.begin)  // the first turn
        for (start = other.begin; start < other.end && high[start] < lowest;) ++start;
      for (int turn = 0; turn < 2; ++turn) start += int{start < other.end} & int{high[start] < lowest};
      int begin = start;
      if (other.begin == column_begin && unmoved) {
        itself = true;
        begin = std::max(begin, c + 1);
      }
      if (begin < other.end) ranges_.push_back({begin, other.end});
    }
    scan_clusters(scan, ranges_.data(), static_cast<int>(ranges_.size()));
    count_ = scan.count;
    add_row(space, c, scan.shift, itself, list);
  }
}

void ClusterSearch::run_all(const SearchSpace& space, int begin_cluster, int end_cluster, int row_atoms,
                            ClusterList& list) {
  list.clear();
  prepare(space);
  const int n = space.clusters.count();
  list.clusters.resize(n);
  for (int c = 0; c < n; ++c) list.clusters[c] = c;
  const int bits = 4 * row_atoms;
  for (int c = begin_cluster; c < end_cluster; ++c) {
    mask_exclusions(space, c);
    for (int first = 0; first < kClusterAtoms; first += row_atoms) {
      PairRow row{};
      row.first = kClusterAtoms * c + first;
      row.shift.setZero();
      for (int i = 0; i < row_atoms; ++i) row.kind |= space.kind[row.first + i];
      const auto add = [&](int begin, int end) {
        row.begin = begin;
        row.end = end;
        row.masked_end = static_cast<int>(list.masked.size());
        if (row.end > row.begin || row.masked_end > row.masked_begin) list.rows.push_back(row);
        row.masked_begin = row.masked_end;
      };
      row.masked_begin = static_cast<int>(list.masked.size());
      int begin = c + 1;  // of the clusters without a mask since the last with one
      for (int j = c; j < n; ++j) {
        const unsigned mask = j == c ? mask_[j] & met_once(space.clusters, c) : mask_[j];
        if (mask == kAll) continue;
        const unsigned part = (mask >> (4 * first)) & ((1u << bits) - 1);
        if (part != 0) list.masked.push_back({j, part});
        if (j > begin) add(begin, j);
        begin = j + 1;
      }
      add(begin, n);
    }
  }
}

}  // namespace taut
