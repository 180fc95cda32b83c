#include "files/dcd_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "base/errors.hpp"
#include "files/akma.hpp"
#include "files/unit_cell.hpp"

namespace taut {
namespace {

constexpr int kTitle = 80;  // characters
constexpr std::uint64_t kHeader = (4 + 84 + 4) + (4 + 4 + kTitle + 4) + (4 + 4 + 4);
constexpr std::uint64_t kControlAt = 8;  // where the header has its integers, after a length and "CORD"

using Control = std::array<std::int32_t, 20>;  // of which one is a real
constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();

Control control_of(const std::filesystem::path& path) {
  Control control{};
  std::ifstream in(path, std::ios::binary);
  in.seekg(kControlAt);
  in.read(reinterpret_cast<char*>(control.data()), sizeof control);
  return control;
}

// Fortran's unformatted records: each between two copies of its length.
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

// Without its integers, which count_frames writes.
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
  }
  count_frames((file_.size() - kHeader) / frame_bytes());
}

std::uint64_t DcdFile::frame_bytes() const {
  const std::uint64_t cell = periodic_ ? 4 + 48 + 4 : 0;
  return cell + 3 * (4 + 4 * static_cast<std::uint64_t>(atoms_) + 4);
}

void DcdFile::count_frames(std::uint64_t frames) {
  const auto n = static_cast<std::int64_t>(frames);
  if (every_ > kMost || first_ > kMost || n > (kMost - first_) / every_) {
    first_ = (first_ + every_ / 2) / every_;
    step_ *= static_cast<float>(every_);
    every_ = 1;
  }
  const auto counted = [](std::int64_t number) { return static_cast<std::int32_t>(std::min(number, kMost)); };
  Control control{};
  control[0] = counted(n);
  control[1] = counted(first_);
  control[2] = counted(every_);
  control[3] = counted(n * every_);
  std::memcpy(&control[9], &step_, sizeof step_);
  control[10] = periodic_ ? 1 : 0;  // with a unit cell
  control[19] = 24;                 // CHARMM's version that brought the format
  file_.rewrite(kControlAt, Records().put(control).bytes());
}

void DcdFile::add(const Frame& frame) {
  Records records;
  if (periodic_) {
    const auto [length, angle] = unit_cell(frame.state.box);
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
  count_frames((file_.size() - kHeader) / frame_bytes());
}

}  // namespace taut
