#include "systems/box_keys.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace taut {

Box read_box(const TomlTable& keys) {
  std::vector<double> numbers;
  if (!keys.read("box_nm", numbers, {"a box's edges, or its vectors in reduced form", "nm"})) return {};
  Eigen::Matrix3d vectors = Eigen::Matrix3d::Zero();
  if (numbers.size() == 3)
    vectors.diagonal() = Vec3(numbers.data());
  else if (numbers.size() == 9)
    vectors = Eigen::Matrix3d(numbers.data());
  else
    keys.fail("box_nm",
              fmt::format("expected 3 numbers, its edges, or 9, its vectors; got {}", numbers.size()));
  if (const std::string flaw = Box::flaw(vectors); !flaw.empty()) keys.fail("box_nm", flaw);
  return Box::of(vectors);
}

Box read_shape(const TomlTable& keys) {
  std::string shape = "cube";
  keys.read("box", shape, {"shape of the box", {"cube", "octahedron", "dodecahedron"}});
  if (shape == "octahedron")
    return {Vec3(1, std::sqrt(8.0) / 3, std::sqrt(6.0) / 3), Vec3(1, -1, std::sqrt(2.0)) / 3};
  if (shape == "dodecahedron") return {Vec3(1, 1, std::sqrt(0.5)), Vec3(0, 0.5, 0.5)};
  return {Vec3::Ones()};
}

}  // namespace taut
