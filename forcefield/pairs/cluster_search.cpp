#include "forcefield/pairs/cluster_search.hpp"

#include <algorithm>
#include <tuple>

#include "base/listen.hpp"

namespace taut {
namespace {

constexpr std::uint16_t kAll = 0xFFFF;
constexpr int kTogether = 6;  // clusters that seek candidates together

// The mask of a cluster with itself: pairs i < j, each once. Fillers repeat the position of another atom and
// are left out.
std::uint16_t pairs_within(const AtomClusters& clusters, int cluster) {
  unsigned mask = 0;
  for (int j = 1; j < kClusterAtoms && !clusters.filler(kClusterAtoms * cluster + j); ++j)
    for (int i = 0; i < j; ++i) mask |= 1u << (4 * i + j);
  return static_cast<std::uint16_t>(mask);
}

bool has_many_types(const SearchSpace& space) {
  return std::ranges::any_of(space.kind, [](auto kind) { return (kind & kHasOtherType) != 0; });
}

}  // namespace

// Clears the bits of excluded pairs in the masks of the partners' clusters. Fillers that repeat a partner are
// excluded too: an excluded pair may be in one place, where even a filler's zero would be 0/0.
void ClusterSearch::mask_exclusions(const SearchSpace& space, int cluster) {
  const auto& [begin, partner] = space.exclusions;
  for (const int j : masked_) mask_[j] = kAll;
  masked_.clear();
  for (int i = 0; i < kClusterAtoms; ++i) {
    const int slot = kClusterAtoms * cluster + i, a = space.clusters.atom(slot);
    for (int e = begin[a]; e < begin[a + 1]; ++e) {
      int other = space.clusters.slot_of(partner[e]);
      if (other < 0) continue;
      std::uint16_t& mask = mask_[other / kClusterAtoms];
      if (mask == kAll) masked_.push_back(other / kClusterAtoms);
      do mask &= std::uint16_t(~(1u << (4 * i + other % kClusterAtoms)));
      while (++other < space.clusters.slots() && space.clusters.filler(other));
    }
  }
}

void ClusterSearch::find_exclusions(const SearchSpace& space, int begin, int end) {
  mask_.assign(space.clusters.count(), kAll);
  masked_.clear();
  begin_ = begin;
  exclude_.clear();
  exclude_begin_.assign(1, 0);
  for (int c = begin; c < end; ++c) {
    mask_exclusions(space, c);
    for (const int j : masked_) exclude_.push_back({j, mask_[j]});
    exclude_begin_.push_back(static_cast<int>(exclude_.size()));
  }
}

void ClusterSearch::run(const SearchSpace& space, int begin, int end, ClusterList& list) {
  list.rows.clear();
  list.masked.clear();
  list.shells.clear();
  many_types_ = has_many_types(space);
  find_exclusions(space, begin, end);
  candidates_.make_room(space.clusters.count());
  partners_.make_room(space.clusters.count());
  seeker_.row_atoms = space.row_atoms;
  seeker_.core2 = static_cast<float>(space.core * space.core);
  for (int s = 0; s < kShells; ++s) {
    const double range = space.list_range(double(s + 1) / kShells);
    seeker_.shell2[s] = static_cast<float>(range * range);
  }
  // along z: the images one box down, in place, one box up
  const int images = space.clusters.box().periodic() ? 1 : 0;
  const auto& columns = space.clusters.columns();
  auto own = std::partition_point(columns.begin(), columns.end(),
                                  [&](const AtomClusters::Column& c) { return c.end <= begin; });
  for (; own != columns.end() && own->begin < end; ++own) {
    hear();
    for (int up = -images; up <= images; ++up) {
      space.clusters.find_neighbours(*own, up, neighbours_);
      for (auto n = neighbours_.begin(); n != neighbours_.end();) {
        const auto first = n;
        ranges_.clear();
        for (; n != neighbours_.end() && n->image == first->image; ++n) ranges_.push_back({n->begin, n->end});
        meet_image(space, {std::max(begin, own->begin), std::min(end, own->end)}, first->shift, list);
      }
    }
  }
}

// Lists rows of the clusters `own` of a column, shifted, with their j-clusters among ranges_.
void ClusterSearch::meet_image(const SearchSpace& space, ClusterRange own, const Vec3& shift,
                               ClusterList& list) {
  const double height = space.clusters.box().edge[2], range = space.list_range(1);
  const bool unmoved = shift.isZero(0);
  for (int begin = own.begin; begin < own.end; begin += kTogether) {
    const int end = std::min(begin + kTogether, own.end);
    Seekers seekers{{}, {}, static_cast<float>(range)};
    for (int d = 0; d < 3; ++d) {
      const auto& [low, high] = std::tie(space.bounds.low[d], space.bounds.high[d]);
      seekers.low[d] =
          static_cast<float>(*std::min_element(low.begin() + begin, low.begin() + end) + shift[d]);
      seekers.high[d] =
          static_cast<float>(*std::max_element(high.begin() + begin, high.begin() + end) + shift[d]);
    }
    if (height > 0 && (seekers.high[2] < -range || seekers.low[2] > height + range)) continue;
    // unshifted, the column is the first of its own neighbours: each pair once
    if (unmoved) ranges_[0].begin = std::max(ranges_[0].begin, begin + 1);
    find_candidates(space.bounds, seekers, ranges_, candidates_);
    for (int c = begin; c < end; ++c) add_row(space, c, shift, list);
  }
}

// Adds the row of a cluster with its j-clusters among candidates_. Unshifted, only clusters after it and the
// cluster itself count.
void ClusterSearch::add_row(const SearchSpace& space, int cluster, const Vec3& shift, ClusterList& list) {
  for (int k = 0; k < 3 * kClusterAtoms; ++k)
    seeker_.x[k] = space.bounds.x[k][cluster] + static_cast<float>(shift[k / 4]);
  seeker_.exclude = exclude_.data() + exclude_begin_[cluster - begin_];
  seeker_.end = exclude_.data() + exclude_begin_[cluster + 1 - begin_];
  PairRow row{};
  row.first = kClusterAtoms * cluster;
  row.shift = shift;
  for (int i = 0; i < kClusterAtoms; ++i) row.kind |= space.kind[row.first + i];
  row.begin = list.rows.empty() ? 0 : list.rows.back().end;
  row.masked_begin = static_cast<int>(list.masked.size());
  int first = 0;
  if (shift.isZero(0)) {
    while (first < candidates_.count && candidates_.cluster[first] <= cluster) ++first;
    const auto* own = std::find_if(seeker_.exclude, seeker_.end,
                                   [&](const MaskedCluster& other) { return other.cluster == cluster; });
    const unsigned mask = (own != seeker_.end ? own->mask : kAll) & pairs_within(space.clusters, cluster);
    if (mask != 0) list.masked.push_back({cluster, mask});
  }
  list.make_room(std::size_t(row.begin) + candidates_.count + SideBySide::kSpare);
  find_partners(candidates_, first, seeker_, partners_, list.clusters.data() + row.begin);
  for (const MaskedCluster& other : partners_.excluded)
    if (other.mask != 0) list.masked.push_back(other);
  ShellEnds ends;
  row.end = row.begin;
  for (std::size_t s = 0; s < ends.size(); ++s) ends[s] = row.end += partners_.count[s];
  row.masked_end = static_cast<int>(list.masked.size());
  const bool one_type = !many_types_ || (row.kind & kHasLj) == 0 || (row.kind & kHasOtherType) != 0;
  one_type ? push(row, ends, list) : split_by_type(space, row, ends, list);
}

void ClusterSearch::push(const PairRow& row, const ShellEnds& ends, ClusterList& list) {
  if (row.end == row.begin && row.masked_end == row.masked_begin) return;
  list.rows.push_back(row);
  list.shells.push_back(ends);
}

// Cuts a row of the usual type in two: its j-clusters of the usual type alone, for which a faster kernel will do, and
// the others. Their order stays.
void ClusterSearch::split_by_type(const SearchSpace& space, const PairRow& row, const ShellEnds& ends,
                                  ClusterList& list) {
  const auto has_other_type = [&](int cluster) {
    const std::uint8_t* kind = space.kind.data() + kClusterAtoms * cluster;
    return ((kind[0] | kind[1] | kind[2] | kind[3]) & kHasOtherType) != 0;
  };
  PairRow usual = row, others = row;
  ShellEnds usual_ends, others_ends;
  set_aside_.clear();
  usual.end = row.begin;
  int k = row.begin;
  for (std::size_t s = 0; s < ends.size(); ++s) {
    for (; k < ends[s]; ++k) {
      const int cluster = list.clusters[k];
      if (has_other_type(cluster))
        set_aside_.push_back(cluster);
      else
        list.clusters[usual.end++] = cluster;
    }
    usual_ends[s] = usual.end;
    others_ends[s] = static_cast<int>(set_aside_.size());
  }
  std::ranges::copy(set_aside_, list.clusters.begin() + usual.end);
  for (int& end : others_ends) end += usual.end;
  others.begin = usual.end;
  masked_aside_.clear();
  int masked = row.masked_begin;
  for (int m = row.masked_begin; m < row.masked_end; ++m) {
    const MaskedCluster of = list.masked[m];
    if (has_other_type(of.cluster))
      masked_aside_.push_back(of);
    else
      list.masked[masked++] = of;
  }
  std::ranges::copy(masked_aside_, list.masked.begin() + masked);
  usual.masked_end = others.masked_begin = masked;
  others.kind |= kHasOtherType;
  push(usual, usual_ends, list);
  push(others, others_ends, list);
}

void ClusterSearch::run_all(const SearchSpace& space, int begin_cluster, int end_cluster, ClusterList& list) {
  list.clear();
  const int n = space.clusters.count(), row_atoms = space.row_atoms;
  mask_.assign(n, kAll);
  masked_.clear();
  list.clusters.resize(n);
  for (int c = 0; c < n; ++c) list.clusters[c] = c;
  const int bits = 4 * row_atoms;
  many_types_ = has_many_types(space);
  for (int c = begin_cluster; c < end_cluster; ++c) {
    mask_exclusions(space, c);
    for (int first = 0; first < kClusterAtoms; first += row_atoms) {
      PairRow row{};
      row.first = kClusterAtoms * c + first;
      row.shift.setZero();
      for (int i = 0; i < row_atoms; ++i) row.kind |= space.kind[row.first + i];
      if (many_types_ && (row.kind & kHasLj) != 0) row.kind |= kHasOtherType;  // of its j-clusters
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
        const unsigned mask = j == c ? mask_[j] & pairs_within(space.clusters, c) : mask_[j];
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
