#include "forcefield/neighbour_list.hpp"

#include <fmt/format.h>

#include "forcefield/nearest_image.hpp"
#include "md/errors.hpp"

namespace taut {
namespace {

// Appends the atoms in `slots` nearer than √range2 to p. Without branches: most are farther.
int scan(const CellList& cells, const CellList::Slots& slots, const Vec3& p, double range2, int* out) {
  const double* q = cells.positions().data() + 3 * slots.begin;
  const int* atoms = cells.atoms();
  const double px = p[0] - slots.shift[0], py = p[1] - slots.shift[1], pz = p[2] - slots.shift[2];
  int found = 0;
  for (int s = slots.begin; s < slots.end; ++s, q += 3) {
    const double dx = q[0] - px, dy = q[1] - py, dz = q[2] - pz;
    out[found] = atoms[s];
    found += dx * dx + dy * dy + dz * dz <= range2;
  }
  return found;
}

void check_finite(const Vectors& x) {
  for (Eigen::Index a = 0; a < x.cols(); ++a)
    if (!x.col(a).allFinite())
      throw SimulationFailure(
          fmt::format("atom {}: position ({}, {}, {}) nm is not finite", a, x(0, a), x(1, a), x(2, a)));
}

}  // namespace

NeighbourList::NeighbourList(const PairRules& rules, const Box& box, ListRange range)
    : sorter_(rules),
      box_(box),
      range_(range),
      in_cells_(CellList::fits(box, range.cutoff + range.buffer)),
      row_(rules.kind.size() + 1) {}

bool NeighbourList::outdated(const Vectors& x) const {
  if (x_built_.cols() != x.cols()) return true;
  const double limit = 0.25 * range_.buffer * range_.buffer;
  bool within = true;
  for (Eigen::Index a = 0; a < x.cols(); ++a)
    within = within & ((x.col(a) - x_built_.col(a)).squaredNorm() <= limit);  // false for NaN
  return !within;
}

bool NeighbourList::update(const Vectors& x) {
  const bool rebuild = outdated(x);
  if (rebuild) {
    check_finite(x);
    for (auto& list : lists_) list.clear();
    candidates_ = 0;
    in_cells_ ? build_from_cells(x) : build_from_all(x);
    x_built_ = x;
  }
  x_ = x + offset_;
  return rebuild;
}

void NeighbourList::build_from_cells(const Vectors& x) {
  const double range = range_.cutoff + range_.buffer, range2 = range * range;
  cells_.build(x, box_, range);
  offset_ = cells_.offsets();
  for (int c = 0; c < cells_.cells(); ++c) {
    const auto& neighbours = cells_.neighbours(c);
    CellList::Slots own = cells_.slots(c);
    while (own.begin < own.end) {
      const int slot = own.begin++;  // `own` is now what comes after it in the cell
      const int atom = cells_.atom(slot);
      if (!sorter_.interacts(atom)) continue;
      const Vec3 p = cells_.positions().col(slot);
      int found = scan(cells_, own, p, range2, row_.data());
      candidates_ += own.end - own.begin;
      const CellList::Slots* last = &own;
      for (const auto& slots : neighbours) {
        if (slots.image != last->image) {  // a row holds one image
          sorter_.add_row({atom, row_.data(), found, last->shift}, lists_);
          found = 0;
        }
        found += scan(cells_, slots, p, range2, row_.data() + found);
        candidates_ += slots.end - slots.begin;
        last = &slots;
      }
      sorter_.add_row({atom, row_.data(), found, last->shift}, lists_);
    }
  }
}

void NeighbourList::build_from_all(const Vectors& x) {
  const NearestImage nearest(box_);
  const double range = range_.cutoff + range_.buffer;
  const int n = static_cast<int>(x.cols());
  offset_.setZero(3, n);
  for (int i = 0; i < n; ++i) {
    int found = 0;
    for (int j = i + 1; j < n; ++j) {
      double dx = x(0, j) - x(0, i), dy = x(1, j) - x(1, i), dz = x(2, j) - x(2, i);
      nearest(dx, dy, dz);
      row_[found] = j;
      found += dx * dx + dy * dy + dz * dz <= range * range;
    }
    candidates_ += n - 1 - i;
    sorter_.add_row({i, row_.data(), found}, lists_);
  }
}

}  // namespace taut
