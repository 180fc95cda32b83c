#include "systems/scene/start_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <iterator>
#include <string>

#include "files/atomic_file.hpp"
#include "files/unit_cell.hpp"

namespace taut {
namespace {

std::string box_line(const Box& box) {
  if (!box.periodic()) return "";
  const Eigen::Matrix3d m = box.vectors();
  if (box.tilt.isZero(0)) return fmt::format("box_nm = [{}, {}, {}]\n", m(0, 0), m(1, 1), m(2, 2));
  return fmt::format("box_nm = [{}]\n", fmt::join(m.data(), m.data() + 9, ", "));
}

}  // namespace

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
  constexpr double kFiveDecimals = 1.1e-5;  // GROMACS's precision
  const ReducedBox read = reduce_box(vectors, kFiveDecimals);
  if (!read.flaw.empty()) keys.fail("box_nm", read.flaw);
  if (!read.changes.empty()) keys.fail("box_nm", Box::flaw(vectors));
  return read.box;
}

Box read_box_shape(const TomlTable& keys) {
  std::string shape = "cube";
  keys.read("box", shape, {"shape of the box", {"cube", "octahedron", "dodecahedron"}});
  if (shape == "octahedron")
    return {Vec3(1, std::sqrt(8.0) / 3, std::sqrt(6.0) / 3), Vec3(1, -1, std::sqrt(2.0)) / 3};
  if (shape == "dodecahedron") return {Vec3(1, 1, std::sqrt(0.5)), Vec3(0, 0.5, 0.5)};
  return {Vec3::Ones()};
}

State read_start(const std::filesystem::path& file) {
  return read_start(parse_toml_file(file), file);
}

State read_start(const toml::table& table, const std::filesystem::path& file) {
  const TomlTable keys(table, file.string());
  State start = read_start(keys);
  keys.reject_unknown();
  return start;
}

State read_start(const TomlTable& keys) {
  State start;
  keys.read("time_ps", start.t, {"time of the state", "ps"});
  start.box = read_box(keys);
  const Rows atoms =
      keys.get_rows("atoms", Columns{6, 6}, "[x, y, z, vx, vy, vz] of each, in nm and nm/ps; never wrapped");

  start.x.resize(3, atoms.size());
  start.v.resize(3, atoms.size());
  for (std::size_t a = 0; a < atoms.size(); ++a) {
    start.x.col(a) = Vec3(atoms[a].data());
    start.v.col(a) = Vec3(atoms[a].data() + 3);
  }
  return start;
}

void write_start(const std::filesystem::path& file, const State& s) {
  constexpr std::size_t kWrittenAtOnce = 1 << 20;  // bytes
  AtomicFile aside(file);
  std::string text = fmt::format("time_ps = {}\n", s.t);
  const auto out = std::back_inserter(text);
  text += box_line(s.box);
  fmt::format_to(out, "atoms = [  # x, y, z [nm], vx, vy, vz [nm/ps]\n");
  for (Eigen::Index a = 0; a < s.x.cols(); ++a) {
    const auto x = s.x.col(a), v = s.v.col(a);
    fmt::format_to(out, "  [{}, {}, {}, {}, {}, {}],\n", x[0], x[1], x[2], v[0], v[1], v[2]);
    if (text.size() < kWrittenAtOnce) continue;
    aside.write(text);
    text.clear();
  }
  text += "]\n";
  aside.write(text);
  aside.commit();
}

}  // namespace taut
