#include "forcefield/pairs/atom_clusters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "base/errors.hpp"
#include "base/shares.hpp"

namespace taut {
namespace {

constexpr int kBuildsPerSurvey = 100;  // how often the density is looked at again
constexpr double kFarthest = 1e15;     // columns
constexpr int kAtomsOfThread = 400;    // fewer are not worth waking a thread for
constexpr int kColumnsOfThread = 8;

std::uint64_t hash(std::int64_t a, std::int64_t b, std::int64_t c = 0) {
  const std::uint64_t h = (std::uint64_t(a) * 0x9E3779B97F4A7C15u) ^
                          (std::uint64_t(b) * 0xC2B2AE3D27D4EB4Fu) ^ (std::uint64_t(c) * 0x165667B19E3779F9u);
  return h ^ (h >> 32);
}

[[noreturn]] void throw_ran_away(int a, double x) {
  throw SimulationFailure(fmt::format("atom {} ran away: a coordinate of {} nm", a, x));
}

}  // namespace

// The volume of the cubes with edge `range` that hold atoms. Cubes are marked by hash: two cubes with the
// same hash count as one, which is good enough for a density.
double AtomClusters::occupied_volume(const Vectors& x) {
  Vec3 edge = Vec3::Constant(layout_.range);
  if (layout_.periodic) edge = box_.edge.array() / (box_.edge / layout_.range).array().floor().max(1);
  marked_.assign(std::bit_ceil(4 * std::size_t(x.cols())), false);
  long cubes = 0;
  for (int a = 0; a < x.cols(); ++a) {
    if (!layout_.present[a]) continue;
    Vec3 p = x.col(a);
    if (layout_.periodic) p += offset_of(p);
    p = p.cwiseQuotient(edge).array().floor();
    for (double c : p)
      if (!(std::abs(c) < kFarthest)) throw_ran_away(a, x.col(a).cwiseAbs().maxCoeff());
    auto mark =
        marked_[hash(std::int64_t(p[0]), std::int64_t(p[1]), std::int64_t(p[2])) & (marked_.size() - 1)];
    cubes += !mark;
    mark = true;
  }
  return double(cubes) * edge.prod();
}

// Shortens gaps wider than two ranges to two ranges: atoms within range of each other have no such gap
// between them. Nothing is done where all atoms are near the origin.
void AtomClusters::close_gaps(const Vectors& x) {
  constexpr double kNear = 64;  // ranges
  const double range = layout_.range, kept = 2 * range;
  for (int d = 0; d < 3; ++d) {
    stretches_[d].assign(1, {0, 0});
    along_.clear();
    double extent = 0;
    for (int a = 0; a < x.cols(); ++a) {
      if (!layout_.present[a]) continue;
      along_.push_back(x(d, a));
      extent = std::max(extent, std::abs(x(d, a)));
      if (!(extent < kFarthest * range)) throw_ran_away(a, x(d, a));
    }
    if (extent <= kNear * range) continue;
    std::sort(along_.begin(), along_.end());
    double last = along_.front(), offset = -last;
    stretches_[d].assign(1, {last, offset});
    for (const double u : along_) {
      if (u - last > kept) {
        offset -= u - last - kept;
        stretches_[d].push_back({u, offset});
      }
      last = u;
    }
  }
}

// What close_gaps() moves an atom at x by along axis d: the offset of its stretch, the last that begins at or before x.
double AtomClusters::offset_along(int d, double x) const {
  const auto next = std::upper_bound(stretches_[d].begin() + 1, stretches_[d].end(), x,
                                     [](double u, const Stretch& s) { return u < s.begin; });
  return std::prev(next)->offset;
}

Vec3 AtomClusters::offset_of(const Vec3& x) const {
  if (layout_.periodic) return -box_.lattice_vector(box_.cell_of(x, std::floor));
  return {offset_along(0, x[0]), offset_along(1, x[1]), offset_along(2, x[2])};
}

// Columns are as wide as the cube that holds eight atoms at the present density. Narrower columns leave few
// near atoms to choose a cluster from; wider ones hold more that are far apart.
void AtomClusters::choose_columns(const Vectors& x) {
  if (builds_ % kBuildsPerSurvey == 0) {
    const auto present = std::count(layout_.present.begin(), layout_.present.end(), 1);
    const double ideal =
        std::cbrt(2 * kClusterAtoms * occupied_volume(x) / double(std::max(1L, long(present))));
    for (int d = 0; d < 2; ++d) {
      count_[d] = layout_.periodic ? std::max(1L, std::lround(box_.edge[d] / ideal)) : 0;
      width_[d] = ideal;
    }
  }
  ++builds_;
  for (int d = 0; d < 2 && layout_.periodic; ++d) width_[d] = box_.edge[d] / double(count_[d]);
}

void AtomClusters::follow(const Box& box) {
  for (Vec3& offset : offset_) offset = box.lattice_vector(box_.fractional(offset).array().round().matrix());
  box_ = box;
}

void AtomClusters::serialize(Archive& archive) {
  long before = std::max(0L, builds_ - 1);  // none where every pair counts
  archive(box_, built_in_, before, width_, count_);
  if (!archive.loading()) return;
  builds_ = before;
  archive.demand_count(before);
  for (int d = 0; d < 2 && before > 0; ++d) {
    archive.demand(width_[d] > 1e-3 * layout_.range);
    archive.demand(!layout_.periodic ||
                   (count_[d] > 0 && built_in_.edge[d] / double(count_[d]) > 1e-3 * layout_.range));
  }
}

// Empty where the atom is too far off.
std::optional<AtomClusters::GridColumn> AtomClusters::find_grid_column(const Vec3& wrapped) const {
  GridColumn place;
  for (int d = 0; d < 2; ++d) {
    const double c = std::floor(wrapped[d] / width_[d]);
    if (!(std::abs(c) < kFarthest)) return {};
    place[d] = static_cast<std::int64_t>(c);
    if (layout_.periodic)
      place[d] = std::clamp<std::int64_t>(place[d], 0, count_[d] - 1);  // rounding on a wall
  }
  return place;
}

std::size_t AtomClusters::table_entry(const GridColumn& place) const {
  const auto another = [&](const GridColumn& found) { return found[0] != place[0] || found[1] != place[1]; };
  std::size_t e = hash(place[0], place[1]) & (table_.size() - 1);
  while (table_[e] >= 0 && another(columns_[table_[e]].place)) e = (e + 1) & (table_.size() - 1);
  return e;
}

// The result does not depend on the number of threads.
void AtomClusters::build(const Vectors& x, const Box& box) {
  const int n = static_cast<int>(x.cols());
  if (layout_.periodic) box_ = built_in_ = box;
  choose_columns(x);
  if (!layout_.periodic) close_gaps(x);
  wrap_.resize(n);
  wrapped_.resize(n);
  grid_column_.resize(n);
  in_shares(n, kAtomsOfThread, [&](const Share& atoms) {
    for (int a = atoms.begin; a < atoms.end; ++a) {
      if (!layout_.present[a]) continue;
      wrap_[a] = offset_of(x.col(a));
      wrapped_[a] = x.col(a) + wrap_[a];
      grid_column_[a] = find_grid_column(wrapped_[a]);
    }
  });
  find_columns(x);
  fill_columns();
  in_shares(static_cast<int>(columns_.size()), kColumnsOfThread, [&](const Share& columns) {
    for (int c = columns.begin; c < columns.end; ++c)
      group_into_clusters(entry_begin_[c], entry_begin_[c + 1]);
  });
  int clusters = 0;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    columns_[c].begin = clusters;
    for (int e = entry_begin_[c]; e < entry_begin_[c + 1]; ++e) clusters += entries_[e].first;
    columns_[c].end = clusters;
  }
  resize_slots(clusters);
  in_shares(static_cast<int>(columns_.size()), kColumnsOfThread, [&](const Share& columns) {
    for (int c = columns.begin; c < columns.end; ++c) fill_slots(c);
  });
}

// The occupied columns, in the order of the grid.
void AtomClusters::find_columns(const Vectors& x) {
  const int n = static_cast<int>(x.cols());
  columns_.clear();
  atoms_in_column_.clear();
  table_.assign(std::bit_ceil(2 * std::size_t(n) + 1), -1);
  column_of_.assign(n, -1);
  for (int a = 0; a < n; ++a) {
    if (!layout_.present[a]) continue;
    if (!grid_column_[a]) throw_ran_away(a, x.col(a).cwiseAbs().maxCoeff());
    int& column = table_[table_entry(*grid_column_[a])];
    if (column < 0) {
      column = static_cast<int>(columns_.size());
      columns_.push_back({*grid_column_[a], 0, 0});
      atoms_in_column_.push_back(0);
    }
    column_of_[a] = column;
    ++atoms_in_column_[column];
  }
  order_.resize(columns_.size());
  std::iota(order_.begin(), order_.end(), 0);
  std::sort(order_.begin(), order_.end(),
            [&](int a, int b) { return columns_[a].place < columns_[b].place; });
  rank_.resize(columns_.size());
  unsorted_ = columns_;
  entry_begin_.assign(1, 0);
  for (std::size_t r = 0; r < order_.size(); ++r) {
    rank_[order_[r]] = static_cast<int>(r);
    columns_[r] = unsorted_[order_[r]];
    entry_begin_.push_back(entry_begin_.back() + atoms_in_column_[order_[r]]);
  }
  for (int& column : table_)
    if (column >= 0) column = rank_[column];
}

// Sorts the atoms into their columns.
void AtomClusters::fill_columns() {
  next_.assign(entry_begin_.begin(), entry_begin_.end());
  entries_.resize(entry_begin_.back());
  for (std::size_t a = 0; a < column_of_.size(); ++a)
    if (column_of_[a] >= 0)
      entries_[next_[rank_[column_of_[a]]]++] = {wrapped_[a][2], static_cast<int>(a), false};
}

// Sorts a column's atoms by z and groups them into clusters.
void AtomClusters::group_into_clusters(int begin, int end) {
  std::sort(entries_.begin() + begin, entries_.begin() + end,
            [](const Entry& a, const Entry& b) { return a.z != b.z ? a.z < b.z : a.atom < b.atom; });
  for (int first = begin; first < end;) {
    const int taken = choose_cluster(first, end);
    entries_[first].first = true;
    first += taken;
  }
}

// Chooses the next cluster of the entries left: the lowest and three of the next seven, none of them too
// high. Let S be the sum of the positions of the n entries and P that of the four chosen. The four spread
// least about their centre, and the rest about theirs, where the two centres are furthest apart: |P − 4S/n|
// is largest. The rest keeps its order. Returns the number of atoms in the cluster.
int AtomClusters::choose_cluster(int first, int end) {
  constexpr int kFew = 2 * kClusterAtoms;
  const double highest = entries_[first].z + tallest();
  std::array<Vec3, kFew> place;
  Vec3 sum = Vec3::Zero();
  int n = 0;
  for (; n < kFew && first + n < end && entries_[first + n].z <= highest; ++n) {
    place[n] = wrapped_[entries_[first + n].atom];
    sum += place[n];
  }
  if (n <= kClusterAtoms) return n;
  double furthest = -1;
  unsigned three = 0;  // a digit of eight each
  const Vec3 lowest = place[0] - kClusterAtoms * sum / n;
  for (int i = 1; i < n; ++i)
    for (int j = i + 1; j < n; ++j) {
      const Vec3 rest = lowest + place[i] + place[j];
      for (int k = j + 1; k < n; ++k) {
        const double apart = (rest + place[k]).squaredNorm();
        three =
            apart > furthest ? unsigned(i << 6 | j << 3 | k) : three;  // no branch: it would be guessed wrong
        furthest = std::max(apart, furthest);
      }
    }
  for (int to = 1; to < kClusterAtoms; ++to) {
    const auto entry = entries_.begin() + first + (three >> (3 * (kClusterAtoms - 1 - to)) & 7);
    std::rotate(entries_.begin() + first + to, entry, entry + 1);
  }
  return kClusterAtoms;
}

void AtomClusters::resize_slots(int clusters) {
  atom_.resize(std::size_t(kClusterAtoms) * clusters);
  offset_.resize(atom_.size());
  slot_of_.assign(wrap_.size(), -1);
}

// Fills the slots of a column's clusters with the atoms of its entries.
void AtomClusters::fill_slots(int column) {
  int cluster = columns_[column].begin;
  const int end = entry_begin_[column + 1];
  for (int e = entry_begin_[column]; e < end; ++cluster) {
    int last = e + 1;
    while (last < end && !entries_[last].first) ++last;
    int slot = kClusterAtoms * cluster;
    for (const bool first : {true, false})
      for (int k = e; k < last; ++k) {
        const int a = entries_[k].atom;
        if (bool(layout_.first[a]) != first) continue;
        slot_of_[a] = slot;
        atom_[slot] = a;
        offset_[slot++] = wrap_[a];
      }
    for (; slot % kClusterAtoms != 0; ++slot) {  // fillers, which count in no pair
      atom_[slot] = atom_[slot - 1];
      offset_[slot] = offset_[slot - 1];
    }
    e = last;
  }
}

void AtomClusters::build_in_order(const Vectors& x) {
  const int n = static_cast<int>(x.cols());
  wrap_.assign(n, Vec3::Zero());
  entries_.clear();
  for (int a = 0; a < n; ++a)
    if (layout_.present[a]) entries_.push_back({0, a, entries_.size() % kClusterAtoms == 0});
  const int atoms = static_cast<int>(entries_.size());
  const int clusters = (atoms + kClusterAtoms - 1) / kClusterAtoms;
  resize_slots(clusters);
  columns_.assign(1, {{0, 0}, 0, clusters});
  entry_begin_ = {0, atoms};
  fill_slots(0);
}

// A column moved by s is near another one where that one moved by −s is near it. Of the two, only the case is
// taken in which the other column is further along x, or at equal x along y, or at equal x and y along z.
void AtomClusters::find_neighbours(const Column& column, int up, std::vector<Neighbour>& out) const {
  out.clear();
  if (!layout_.periodic) {
    add_neighbours_of_image(column, Vec3::Zero(), out);
  } else {
    // the images whose corner lies within range of the unit cell
    const double range = layout_.range;
    const double y = double(column.place[1]) * width_[1] + up * box_.tilt[2];
    const double x = double(column.place[0]) * width_[0] + up * box_.tilt[1];
    for (double b = std::ceil((-range - width_[1] - y) / box_.edge[1]);
         y + b * box_.edge[1] < box_.edge[1] + range; ++b)
      for (double a = std::ceil((-range - width_[0] - x - b * box_.tilt[0]) / box_.edge[0]);
           x + b * box_.tilt[0] + a * box_.edge[0] < box_.edge[0] + range; ++a)
        add_neighbours_of_image(column, {a, b, double(up)}, out);
  }
  std::sort(out.begin(), out.end(), [](const Neighbour& a, const Neighbour& b) {
    return a.image != b.image ? a.image < b.image : a.begin < b.begin;
  });
}

// Adds the neighbours of one image of the column.
void AtomClusters::add_neighbours_of_image(const Column& column, const Vec3& steps,
                                           std::vector<Neighbour>& out) const {
  const Vec3 shift = box_.lattice_vector(steps);
  const int image = (16 - static_cast<int>(steps[0])) * 32 + 16 - static_cast<int>(steps[1]);
  const double range2 = layout_.range * layout_.range;
  GridColumn first, last;
  for (int d = 0; d < 2; ++d) {
    const auto place = column.place[d] + std::int64_t(std::floor(shift[d] / width_[d]));
    const auto columns = static_cast<std::int64_t>(layout_.range / width_[d]) + 2;
    first[d] = place - columns;
    last[d] = place + columns;
    if (!layout_.periodic) continue;
    first[d] = std::max<std::int64_t>(first[d], 0);
    last[d] = std::min(last[d], count_[d] - 1);
  }
  const auto further = [&](int d, std::int64_t place) {  // the other is, corner from corner [nm]
    return double(place - column.place[d]) * width_[d] - shift[d];
  };
  const auto gap = [&](int d, double corners) { return std::max(0.0, std::abs(corners) - width_[d]); };
  for (std::int64_t px = first[0]; px <= last[0]; ++px)
    for (std::int64_t py = first[1]; py <= last[1]; ++py) {
      const double dx = further(0, px), dy = further(1, py), gx = gap(0, dx), gy = gap(1, dy);
      // Of two columns one finds the other, so that each pair is met once.
      if (dx < 0 || (dx == 0 && (dy < 0 || (dy == 0 && steps[2] < 0)))) continue;
      if (gx * gx + gy * gy > range2 * (1 + 1e-9)) continue;
      const int found = table_[table_entry({px, py})];
      if (found >= 0) out.push_back({columns_[found].begin, columns_[found].end, image, shift});
    }
}

}  // namespace taut
