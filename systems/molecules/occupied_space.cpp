#include "systems/molecules/occupied_space.hpp"

#include <cmath>

namespace taut {

Vec3 OccupiedSpace::wrap(const Vec3& x) const {
  if (!box_.periodic()) return x;
  return x - box_.lattice_vector(box_.cell_of(x, std::floor));
}

OccupiedSpace::Cell OccupiedSpace::cell_of(const Vec3& x) const {
  Cell cell;
  for (int d = 0; d < 3; ++d) cell[d] = static_cast<long>(std::floor(x[d] / cell_));
  return cell;
}

// Adds the sphere and all its images within a cell's width of the unit cell, so that a look-up in the unit
// cell needs no wrap. With tilts of up to half an edge, b and c may shift an image by two edges along a.
void OccupiedSpace::add(const Vec3& x, double radius) {
  const int n = size();
  const Vec3 at = wrap(x);
  std::vector<Cell>& put = put_.emplace_back();
  const auto add_image = [&](const Vec3& image) {
    put.push_back(cell_of(image));
    cells_[put.back()].push_back({image, radius, n});
  };
  if (!box_.periodic()) return add_image(at);
  for (int k = 0; k < 45; ++k) {
    const Vec3 image = at + box_.lattice_vector(Vec3(k % 5 - 2, k / 5 % 3 - 1, k / 15 - 1));
    if ((image.array() >= -cell_).all() && (image.array() < box_.edge.array() + cell_).all())
      add_image(image);
  }
}

void OccupiedSpace::remove_from(int n) {
  for (; size() > n; put_.pop_back())
    for (const Cell& cell : put_.back()) cells_[cell].pop_back();
}

}  // namespace taut
