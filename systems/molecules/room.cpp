#include "systems/molecules/room.hpp"

#include <cmath>

namespace taut {

Vec3 Room::home(const Vec3& x) const {
  if (!box_.periodic()) return x;
  return x - box_.lattice_vector(box_.cell_of(x, std::floor));
}

Room::Cell Room::cell_of(const Vec3& x) const {
  Cell cell;
  for (int d = 0; d < 3; ++d) cell[d] = static_cast<long>(std::floor(x[d] / cell_));
  return cell;
}

// Beside itself, all its images within a cell's width of the brick: whoever is at home there finds them.
// Tilted by up to half an edge each, b and c can take an image two edges along a.
void Room::take(const Vec3& x, double radius) {
  const int n = taken();
  const Vec3 at = home(x);
  std::vector<Cell>& put = put_.emplace_back();
  const auto add = [&](const Vec3& image) {
    put.push_back(cell_of(image));
    cells_[put.back()].push_back({image, radius, n});
  };
  if (!box_.periodic()) return add(at);
  for (int k = 0; k < 45; ++k) {
    const Vec3 image = at + box_.lattice_vector(Vec3(k % 5 - 2, k / 5 % 3 - 1, k / 15 - 1));
    if ((image.array() >= -cell_).all() && (image.array() < box_.edge.array() + cell_).all()) add(image);
  }
}

void Room::release(int n) {
  for (; taken() > n; put_.pop_back())
    for (const Cell& cell : put_.back()) cells_[cell].pop_back();
}

}  // namespace taut
