#include "files/dcd_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "base/errors.hpp"
#include "files/unit_cell.hpp"

namespace taut {
namespace {

constexpr int kTitle = 80;  // characters
constexpr std::uint64_t kHeader = (4 + 84 + 4) + (4 + 4 + kTitle + 4) + (4 + 4 + 4);
constexpr std::uint64_t kControlAt = 8;  // offset of the header's integers, after a length and "CORD"

using Control = std::array<std::int32_t, 20>;  // number 9, the time step, is a float
constexpr std::int64_t kLargestCount = std::numeric_limits<std::int32_t>::max();

Control control_of(const std::filesystem::path& path) {
  Control control{};
  std::ifstream in(path, std::ios::binary);
  in.seekg(kControlAt);
  in.read(reinterpret_cast<char*>(control.data()), sizeof control);
  return control;
}

// A DCD file is a sequence of Fortran's unformatted records. Each stands between two copies of its length in
// bytes.
class Records {
 public:
  template <class T>
  Records& put(const T& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  Records& text(std::string_view words, std::size_t width) {
    bytes_.append(words.substr(0, width)).append(width - std::min(width, words.size()), ' ');
    return *this;
  }
  Records& bound(std::size_t length) { return put(static_cast<std::uint32_t>(length)); }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

// The header. Its integers are zero here: write_counts() writess.
std::string header(const TrajectorySetup& setup) {
  Records records;
  records.bound(84).text("CORD", 4).put(Control{}).bound(84);
  records.bound(4 + kTitle).put(std::int32_t{1}).text("taut: positions, unwrapped", kTitle).bound(4 + kTitle);
  records.bound(4).put(static_cast<std::int32_t>(setup.sys.atoms())).bound(4);
  return records.bytes();
}

}  // namespace

DcdFile::DcdFile(const std::filesystem::path& path, const TrajectorySetup& setup, std::uint64_t mark)
    : file_(path, mark),
      periodic_(setup.periodic),
      atoms_(setup.sys.atoms()),
      first_(std::lround(setup.t0 / setup.h)),
      every_(setup.every),
      step_(static_cast<float>(setup.h / kAkma)) {
  if (mark == 0) file_.write(header(setup));
  if (file_.size() < kHeader || (file_.size() - kHeader) % frame_bytes() != 0)
    throw OutsideError(fmt::format("{}: cannot go on: its frames are of another size", path.string()));
  if (mark > 0) {
    const Control control = control_of(path);
    first_ = control[1];
    every_ = control[2];
    std::memcpy(&step_, &control[9], sizeof step_);
    if (every_ < 1 || !(step_ > 0) || !std::isfinite(step_))
      throw OutsideError(
          fmt::format("{}: cannot go on: its header has {} steps of {} AKMA units of time between frames, "
                      "expected more than 0 of "
                      "both; its frames may be whole, but it was changed by another program",
                      path.string(), every_, step_));
  }
  write_counts((file_.size() - kHeader) / frame_bytes());
}

std::uint64_t DcdFile::frame_bytes() const {
  const std::uint64_t cell = periodic_ ? 4 + 48 + 4 : 0;
  return cell + 3 * (4 + 4 * static_cast<std::uint64_t>(atoms_) + 4);
}

void DcdFile::write_counts(std::uint64_t frames) {
  const auto n = static_cast<std::int64_t>(frames);
  if (every_ > kLargestCount || first_ > kLargestCount || n > (kLargestCount - first_) / every_) {
    first_ = (first_ + every_ / 2) / every_;
    step_ *= static_cast<float>(every_);
    every_ = 1;
  }
  const auto counted = [](std::int64_t number) {
    return static_cast<std::int32_t>(std::min(number, kLargestCount));
  };
  Control control{};
  control[0] = counted(n);
  control[1] = counted(first_);
  control[2] = counted(every_);
  control[3] = counted(n * every_);
  std::memcpy(&control[9], &step_, sizeof step_);
  control[10] = periodic_ ? 1 : 0;  // 1: frames have a unit cell
  control[19] = 24;                 // version of CHARMM that defines this format
  file_.rewrite(kControlAt, Records().put(control).bytes());
}

void DcdFile::add(const Frame& frame) {
  Records records;
  if (periodic_) {
    const auto [length, angle] = to_unit_cell(frame.state.box);
    records.bound(48).put(length[0]).put(angle[2]).put(length[1]).put(angle[1]).put(angle[0]).put(length[2]);
    records.bound(48);
  }
  const std::size_t length = 4 * static_cast<std::size_t>(atoms_);
  for (int axis = 0; axis < 3; ++axis) {
    records.bound(length);
    for (long a = 0; a < atoms_; ++a) records.put(static_cast<float>(10 * frame.state.x(axis, a)));
    records.bound(length);
  }
  file_.write(records.bytes());
  write_counts((file_.size() - kHeader) / frame_bytes());
}

bool DcdReader::read_record(std::size_t length, void* into) {
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
  if (!read_record(head.size(), head.data()) || std::memcmp(head.data(), "CORD", 4) != 0 ||
      !read_record(title.size(), title.data()) || !read_record(sizeof atoms, &atoms) || atoms < 1)
    throw InputError(path.string() + ": expected a trajectory in DCD as taut writes it");
  std::array<std::int32_t, 20> control{};
  std::memcpy(control.data(), head.data() + 4, sizeof control);
  if (control[8] != 0 || control[11] != 0)
    throw InputError(path.string() + ": has fixed atoms or a fourth dimension, which taut does not read");
  float step = 0;
  std::memcpy(&step, &control[9], sizeof step);
  atoms_ = atoms;
  periodic_ = control[10] != 0;
  interval_ = control[2] * static_cast<double>(step) * kAkma;
  first_ = control[1] * static_cast<double>(step) * kAkma;
  frames_begin_ = in_.tellg();
}

std::streamoff DcdReader::frame_bytes() const {
  constexpr std::streamoff kMarks = 2 * sizeof(std::uint32_t);  // around each record
  const std::streamoff cell = periodic_ ? 6 * sizeof(double) + kMarks : 0;
  return cell +
         3 * (static_cast<std::streamoff>(atoms_) * static_cast<std::streamoff>(sizeof(float)) + kMarks);
}

long DcdReader::frames() const {
  const auto bytes = static_cast<std::streamoff>(std::filesystem::file_size(path_));
  return static_cast<long>((bytes - frames_begin_) / frame_bytes());
}

void DcdReader::skip() {
  in_.seekg(frame_bytes(), std::ios::cur);
}

bool DcdReader::next(Vectors& x, Box& box) {
  if (periodic_) {
    std::array<double, 6> cell{};  // |a|, γ, |b|, β, α, |c|
    if (!read_record(sizeof cell, cell.data())) return false;
    box = to_box({{cell[0], cell[2], cell[5]}, {cell[4], cell[3], cell[1]}});
  }
  std::vector<float> row(static_cast<std::size_t>(atoms_));
  x.resize(3, atoms_);
  for (int axis = 0; axis < 3; ++axis) {
    if (!read_record(row.size() * sizeof(float), row.data())) return false;
    for (int a = 0; a < atoms_; ++a) x(axis, a) = static_cast<double>(row[static_cast<std::size_t>(a)]) / 10;
  }
  return true;
}

}  // namespace taut
