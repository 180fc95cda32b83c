#include "forcefield/cell_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "md/errors.hpp"

namespace taut {
namespace {

// Half of the cells up to `reach` away, one of each opposite pair.
void half_shell(int reach, std::vector<std::array<std::int64_t, 3>>& offsets) {
  offsets.clear();
  for (int z = 0; z <= reach; ++z)
    for (int y = z > 0 ? -reach : 0; y <= reach; ++y)
      for (int x = z > 0 || y > 0 ? -reach : 1; x <= reach; ++x) offsets.push_back({x, y, z});
}

int cells_along(double edge, double range, int reach) {
  return static_cast<int>(edge * reach / range);
}

bool reach_fits(const Box& box, double range, int reach) {
  return !box.periodic() || cells_along(box.edge.minCoeff(), range, reach) >= 2 * reach + 1;
}

}  // namespace

bool CellList::fits(const Box& box, double range) {
  return reach_fits(box, range, 1) || reach_fits(box, range, 2);
}

// Crowded space is cut into cells of half the range: more of them to visit, but hugging the sphere closer.
void CellList::lay_grid(const Vectors& x, const Box& box, double range) {
  constexpr double kCrowd = 16;  // atoms in a cube of the range
  const Vec3 extent = box.periodic() ? box.edge : Vec3(x.rowwise().maxCoeff() - x.rowwise().minCoeff());
  const double cubes = (extent / range).cwiseMax(1).prod();
  const bool crowded = double(x.cols()) > kCrowd * cubes;
  const int reach = (crowded && reach_fits(box, range, 2)) || !reach_fits(box, range, 1) ? 2 : 1;
  if (reach != reach_ || offsets_.empty()) half_shell(reach, offsets_);
  reach_ = reach;
  box_ = box;
  for (int d = 0; d < 3; ++d) {
    count_[d] = box.periodic() ? cells_along(box.edge[d], range, reach) : 0;
    cell_edge_[d] = box.periodic() ? box.edge[d] / double(count_[d]) : range / reach;
  }
}

CellList::Key CellList::locate(int a, const Vec3& x, Vec3& offset) const {
  Key key;
  for (int d = 0; d < 3; ++d) {
    offset[d] = box_.periodic() ? -box_.edge[d] * std::floor(x[d] / box_.edge[d]) : 0.0;
    const double c = std::floor((x[d] + offset[d]) / cell_edge_[d]);
    if (!(std::abs(c) < 1e15))
      throw SimulationFailure(fmt::format("atom {} ran away: a coordinate of {} nm", a, x[d]));
    key[d] = static_cast<std::int64_t>(c);
    if (box_.periodic()) key[d] = std::clamp<std::int64_t>(key[d], 0, count_[d] - 1);  // rounding on a wall
  }
  return key;
}

std::size_t CellList::entry(const Key& key) const {
  const std::uint64_t h = (std::uint64_t(key[0]) * 0x9E3779B97F4A7C15u) ^
                          (std::uint64_t(key[1]) * 0xC2B2AE3D27D4EB4Fu) ^
                          (std::uint64_t(key[2]) * 0x165667B19E3779F9u);
  std::size_t e = (h ^ (h >> 32)) & (table_.size() - 1);
  while (table_[e] >= 0 && keys_[table_[e]] != key) e = (e + 1) & (table_.size() - 1);
  return e;
}

void CellList::build(const Vectors& x, const Box& box, double range) {
  const int n = static_cast<int>(x.cols());
  keys_.clear();
  begin_.assign(1, 0);
  if (n == 0) return;
  lay_grid(x, box, range);
  table_.assign(std::bit_ceil(2 * std::size_t(n)), -1);
  cell_of_.resize(n);
  offset_.resize(3, n);
  for (int a = 0; a < n; ++a) {
    Vec3 offset;
    const Key key = locate(a, x.col(a), offset);
    offset_.col(a) = offset;
    int& cell = table_[entry(key)];
    if (cell < 0) {
      cell = cells();
      keys_.push_back(key);
      begin_.push_back(0);
    }
    cell_of_[a] = cell;
    ++begin_[cell + 1];
  }

  // counting sort
  for (int c = 0; c < cells(); ++c) begin_[c + 1] += begin_[c];
  next_ = begin_;
  atom_.resize(n);
  position_.resize(3, n);
  for (int a = 0; a < n; ++a) {
    const int slot = next_[cell_of_[a]]++;
    atom_[slot] = a;
    position_.col(slot) = x.col(a) + offset_.col(a);
  }
}

const std::vector<CellList::Slots>& CellList::neighbours(int cell) {
  neighbours_.clear();
  for (const Key& offset : offsets_) {
    Key key = keys_[cell];
    Vec3 shift = Vec3::Zero();
    int image = 0;  // three digits, an edge each: none, one down, one up
    for (int d = 0; d < 3; ++d) {
      image *= 3;
      key[d] += offset[d];
      if (!box_.periodic()) continue;
      if (key[d] < 0) {
        key[d] += count_[d];
        shift[d] = -box_.edge[d];
        image += 1;
      } else if (key[d] >= count_[d]) {
        key[d] -= count_[d];
        shift[d] = box_.edge[d];
        image += 2;
      }
    }
    const int other = table_[entry(key)];
    if (other >= 0) neighbours_.push_back({begin_[other], begin_[other + 1], image, shift});
  }
  std::sort(neighbours_.begin(), neighbours_.end(), [](const Slots& a, const Slots& b) {
    return a.image != b.image ? a.image < b.image : a.begin < b.begin;
  });
  return neighbours_;
}

}  // namespace taut
