#include "files/coordinate_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <vector>

#include "base/errors.hpp"
#include "files/unit_cell.hpp"

namespace taut {
namespace {

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == text.npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") + 1 - first));
}

// Reads a file line by line, and numbers by their columns.
class Lines {
 public:
  explicit Lines(const std::filesystem::path& file) : file_(file.string()), in_(file, std::ios::binary) {
    if (!std::filesystem::is_regular_file(file) || !in_) throw InputError(file_ + ": no such file");
  }

  bool next() {
    ++number_;
    return static_cast<bool>(std::getline(in_, line));
  }
  std::string columns(std::size_t first, std::size_t width) const {
    return first < line.size() ? trimmed(std::string_view(line).substr(first, width)) : "";
  }
  double number(std::size_t first, std::size_t width, const char* what) const {
    return to_number(columns(first, width), what);
  }
  double to_number(const std::string& text, const char* what) const {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
      fail(fmt::format("expected {}, got \"{}\"", what, text));
    return value;
  }
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(fmt::format("{}:{}: {}", file_, number_, message));
  }

  const std::string& file() const { return file_; }

  std::string line;

 private:
  std::string file_;
  std::ifstream in_;
  int number_ = 0;
};

// Collects atoms in the order of the file.
class AtomCollector {
 public:
  // A new residue begins where the text `residue` differs from the last atom's.
  void add(const Vec3& x, const AtomKind& kind, const std::string& residue) {
    x_.push_back(x);
    const auto [at, fresh] = known_.try_emplace(kind, static_cast<int>(names_.kinds.size()));
    if (fresh) names_.kinds.push_back(kind);
    names_.kind.push_back(at->second);
    if (!names_.residue.empty() && residue != last_) ++count_;
    names_.residue.push_back(count_);
    last_ = residue;
  }
  void add_velocity(const Vec3& v) { v_.push_back(v); }

  // These atoms may be the first frame of many.
  Coordinates make_coordinates(const ReducedBox& from, bool of_many, const Lines& lines) const {
    Coordinates all{columns(x_), columns(v_), from.box, names_, ""};
    if (!from.changes.empty()) {
      const Vec3& tilt = from.box.tilt;
      all.note = fmt::format(
          "{}: its box is reduced to bx = {:.6g}, cx = {:.6g}, cy = {:.6g} nm ({}), which leaves the lattice "
          "as it is",
          lines.file(), tilt[0], tilt[1], tilt[2], from.changes);
    }
    if (of_many)
      all.note +=
          fmt::format("{}the first of its frames is taken", all.note.empty() ? lines.file() + ": " : "; ");
    return all;
  }
  std::size_t size() const { return x_.size(); }
  bool some_move() const { return !v_.empty() && v_.size() != x_.size(); }

 private:
  static Vectors columns(const std::vector<Vec3>& all) {
    Vectors x(3, all.size());
    for (std::size_t a = 0; a < all.size(); ++a) x.col(a) = all[a];
    return x;
  }

  std::vector<Vec3> x_, v_;
  Names names_;
  std::map<AtomKind, int> known_;
  std::string last_;
  int count_ = 0;
};

// Reduces a box and refuses what is none. `rounding` is the largest error that the format's decimals leave
// in a tilt [nm].
ReducedBox reduce_checked(const Eigen::Matrix3d& vectors, double rounding, const Lines& lines) {
  const ReducedBox read = reduce_box(vectors, rounding);
  if (!read.flaw.empty()) lines.fail("its box: " + read.flaw);
  return read;
}

// Reads CRYST1's lengths and angles. A cell of 1 Å in each direction stands for no box (wwPDB's convention).
ReducedBox read_cell(const Lines& lines) {
  UnitCell cell;  // lengths in nm
  auto& [length, angle] = cell;
  for (int d = 0; d < 3; ++d) {
    length[d] = 0.1 * lines.number(6 + 9 * d, 9, "an edge");
    angle[d] = lines.number(33 + 7 * d, 7, "an angle");
  }
  if (length == std::array{0.1, 0.1, 0.1} || length == std::array{0.0, 0.0, 0.0}) return {};
  const auto [least, most] = std::ranges::minmax(angle);
  const double sum = angle[0] + angle[1] + angle[2];
  if (!(least > 0) || !(sum < 360) || !(2 * most < sum))
    lines.fail(
        fmt::format("its box: angles of {}, {} and {} degrees, expected each to be less than the other two "
                    "together, and all to be less than 360",
                    angle[0], angle[1], angle[2]));
  // Lengths have three decimals in Å. Angles have two in degrees, an error of 1e-4 rad that enters twice.
  const double rounding = 1e-4 + 2e-4 * *std::ranges::max_element(length);
  return reduce_checked(lattice_vectors(cell), rounding, lines);
}

Coordinates read_pdb(Lines& lines) {
  AtomCollector atoms;
  ReducedBox box;
  bool ended = false, many = false;
  while (!many && lines.next()) {
    const std::string record = lines.columns(0, 6);
    if (record == "CRYST1" && !ended) box = read_cell(lines);
    if (record == "ENDMDL" || record == "END") ended = true;
    if (record != "ATOM" && record != "HETATM") continue;
    many = ended;
    if (many) continue;
    if (const std::string other = lines.columns(16, 1); !other.empty() && other != "A")
      lines.fail(fmt::format("alternate location {}, expected one place for each atom", other));
    Vec3 x;
    for (int d = 0; d < 3; ++d) x[d] = 0.1 * lines.number(30 + 8 * d, 8, "a position");
    std::string element = lines.columns(76, 2);
    if (element == "X") element.clear();  // as a file says that there is none
    if (element.size() == 2) element[1] = static_cast<char>(std::tolower(element[1]));
    atoms.add(x, {lines.columns(12, 4), lines.columns(17, 4), element}, lines.columns(17, 10));
  }
  if (atoms.size() == 0) lines.fail("there are no atoms in it");
  return atoms.make_coordinates(box, many, lines);
}

// Reads the box: three edges, or v1(x) v2(y) v3(z) v1(y) v1(z) v2(x) v2(z) v3(x) v3(y).
ReducedBox read_gro_box(Lines& lines) {
  std::istringstream words(lines.line);
  std::vector<double> n;
  std::size_t decimals = 0;
  for (std::string word; words >> word;) {
    n.push_back(lines.to_number(word, "an edge of the box"));
    if (const auto point = word.find('.'); point != word.npos)
      decimals = std::max(decimals, word.size() - point - 1);
  }
  if (n.size() != 3 && n.size() != 9) lines.fail("expected the box, 3 or 9 numbers");
  n.resize(9);
  if (n == std::vector<double>(9)) return {};
  Eigen::Matrix3d m;
  m << n[0], n[5], n[7], n[3], n[1], n[8], n[4], n[6], n[2];
  // Edge and tilt are each rounded to the same decimals: together the error is below one unit of the last.
  return reduce_checked(m, 1.1 * std::pow(10.0, -static_cast<double>(decimals)), lines);
}

Coordinates read_gro(Lines& lines) {
  lines.next();
  lines.next();
  const double count = lines.to_number(trimmed(lines.line), "the number of atoms");
  AtomCollector atoms;
  for (double a = 0; a < count; ++a) {
    if (!lines.next()) lines.fail(fmt::format("expected {} atoms, got {}", count, a));
    // The width of a column is the distance between two decimal points.
    const auto point = lines.line.find('.', 20);
    const auto second = point == std::string::npos ? point : lines.line.find('.', point + 1);
    if (second == std::string::npos) lines.fail("expected three positions");
    const auto width = second - point;
    Vec3 x, v;
    for (int d = 0; d < 3; ++d) x[d] = lines.number(20 + d * width, width, "a position");
    atoms.add(x, {lines.columns(10, 5), lines.columns(5, 5), ""}, lines.columns(0, 10));
    if (lines.columns(20 + 3 * width, 3 * width).empty()) continue;
    for (int d = 0; d < 3; ++d) v[d] = lines.number(20 + (3 + d) * width, width, "a velocity");
    atoms.add_velocity(v);
  }
  if (!lines.next()) lines.fail("expected the box, 3 or 9 numbers");
  const ReducedBox box = read_gro_box(lines);
  if (atoms.some_move()) lines.fail("some atoms have velocities, others none");
  bool many = false;
  while (!many && lines.next()) many = !trimmed(lines.line).empty();
  return atoms.make_coordinates(box, many, lines);
}

}  // namespace

Coordinates read_coordinates(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  const bool pdb = ending == ".pdb" || ending == ".ent";
  if (!pdb && ending != ".gro")
    throw InputError(fmt::format("{}: expected a file of coordinates, .pdb or .gro", file.string()));
  Lines lines(file);
  return pdb ? read_pdb(lines) : read_gro(lines);
}

}  // namespace taut
