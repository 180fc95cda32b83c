#include "files/dcd_reader.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "base/errors.hpp"
#include "files/akma.hpp"
#include "files/unit_cell.hpp"

namespace taut {

// A record stands between two copies of its length.
bool DcdReader::record(std::size_t length, void* into) {
  std::uint32_t before = 0, after = 0;
  in_.read(reinterpret_cast<char*>(&before), sizeof before);
  if (!in_ || before != length) return false;
  in_.read(static_cast<char*>(into), static_cast<std::streamsize>(length));
  in_.read(reinterpret_cast<char*>(&after), sizeof after);
  return in_ && after == length;
}

DcdReader::DcdReader(const std::filesystem::path& path) : path_(path), in_(path, std::ios::binary) {
  if (!in_) throw InputError(path.string() + ": cannot be read");
  std::array<char, 84> head{};
  std::array<char, 84> title{};
  std::int32_t atoms = 0;
  if (!record(head.size(), head.data()) || std::memcmp(head.data(), "CORD", 4) != 0 ||
      !record(title.size(), title.data()) || !record(sizeof atoms, &atoms) || atoms < 1)
    throw InputError(path.string() + ": expected a trajectory in DCD as taut writes it");
  std::array<std::int32_t, 20> control{};
  std::memcpy(control.data(), head.data() + 4, sizeof control);
  float step = 0;
  std::memcpy(&step, &control[9], sizeof step);
  atoms_ = atoms;
  periodic_ = control[10] != 0;
  interval_ = control[2] * static_cast<double>(step) * kAkma;
}

bool DcdReader::next(Vectors& x, Box& box) {
  if (periodic_) {
    std::array<double, 6> cell{};  // |a|, γ, |b|, β, α, |c|
    if (!record(sizeof cell, cell.data())) return false;
    box = box_of({{cell[0], cell[2], cell[5]}, {cell[4], cell[3], cell[1]}});
  }
  std::vector<float> row(static_cast<std::size_t>(atoms_));
  x.resize(3, atoms_);
  for (int axis = 0; axis < 3; ++axis) {
    if (!record(row.size() * sizeof(float), row.data())) return false;
    for (int a = 0; a < atoms_; ++a) x(axis, a) = static_cast<double>(row[static_cast<std::size_t>(a)]) / 10;
  }
  return true;
}

}  // namespace taut
