#include "systems/box_keys.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "files/reduced_box.hpp"

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
  constexpr double kFiveDecimals = 1.1e-5;  // as GROMACS writes them
  const ReducedBox read = reduced_box(vectors, kFiveDecimals);
  if (!read.flaw.empty()) keys.fail("box_nm", read.flaw);
  if (!read.changes.empty()) keys.fail("box_nm", Box::flaw(vectors));
  return read.box;
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
