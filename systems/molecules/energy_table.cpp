#include "systems/molecules/energy_table.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <numbers>
#include <optional>

namespace taut {
namespace {

constexpr double kUneven = 1e-3;       // largest error of a row's place, in spacings: of rounded decimals
constexpr double kSlopeError = 0.02;   // largest error of a force, relative to those around it
constexpr double kEnergyError = 2e-5;  // and of what it does over two spacings: of rounded decimals [kJ/mol]

struct TableRow {
  std::size_t line;
  std::vector<double> numbers;  // where, energy and perhaps force
};

// The numbers of a line; none where it has something else.
std::optional<std::vector<double>> numbers_of(std::string_view line) {
  std::vector<double> numbers;
  constexpr std::string_view kBetween = " \t\r,;";
  for (;;) {
    line.remove_prefix(std::min(line.find_first_not_of(kBetween), line.size()));
    if (line.empty()) return numbers;
    const std::string_view word = line.substr(0, line.find_first_of(kBetween));
    line.remove_prefix(word.size());
    const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
    double number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(number)) return {};
    numbers.push_back(number);
  }
}

class TableFile {
 public:
  TableFile(const std::filesystem::path& file, TableOf of) : name_(file.filename().string()), of_(of) {
    std::ifstream in(file);
    if (!in) throw InputError(file.string() + ": cannot be read");
    read_rows(in);
    if (rows_.size() < 3) refuse(1, fmt::format("has {} rows, expected 3 or more", rows_.size()));
    check_range();
    check_spacing();
    if (rows_[0].numbers.size() == 3) check_forces();
  }

  std::shared_ptr<const Spline> spline() const {
    std::vector<double> energies;
    for (const TableRow& row : rows_) energies.push_back(row.numbers[1]);
    const double unit = of_ == TableOf::kAngle ? std::numbers::pi / 180 : 1;
    return std::make_shared<const Spline>(name_, unit * at(0), unit * at(rows_.size() - 1),
                                          std::move(energies));
  }

 private:
  [[noreturn]] void refuse(std::size_t line, const std::string& what) const {
    throw InputError(fmt::format("{}:{}: {}", name_, line, what));
  }
  const char* unit() const { return of_ == TableOf::kAngle ? "degrees" : "nm"; }
  double at(std::size_t row) const { return rows_[row].numbers[0]; }
  double energy(std::size_t row) const { return rows_[row].numbers[1]; }
  double force(std::size_t row) const { return rows_[row].numbers[2]; }

  void read_rows(std::ifstream& in) {
    std::size_t line = 0;
    bool first = true;
    for (std::string text; std::getline(in, text);) {
      ++line;
      const auto numbers = numbers_of(std::string_view(text).substr(0, text.find('#')));
      const bool heading = std::exchange(first, first && numbers && numbers->empty());
      if (numbers && numbers->empty()) continue;
      if (!numbers && heading) continue;  // names of the columns
      if (!numbers) refuse(line, fmt::format("expected numbers, got \"{}\"", one_line(text)));
      const std::size_t columns = rows_.empty() ? numbers->size() : rows_[0].numbers.size();
      if (columns == 4)
        refuse(
            line,
            "has 4 numbers, expected a distance or angle, an energy and perhaps a force; if it is a table of "
            "LAMMPS's, leave out the index in front, and change its units to nm, degrees and kJ/mol");
      if (columns < 2 || columns > 3 || numbers->size() != columns)
        refuse(line, fmt::format("has {} numbers, expected {}", numbers->size(),
                                 rows_.empty() ? "2 or 3" : fmt::format("{}, as above", columns)));
      rows_.push_back({line, *numbers});
    }
  }

  void check_range() const {
    const double most = of_ == TableOf::kAngle ? 180 : HUGE_VAL;
    for (const TableRow& row : rows_)
      if (row.numbers[0] < 0 || row.numbers[0] > most)
        refuse(row.line, of_ == TableOf::kAngle
                             ? fmt::format("an angle of {:g}, expected 0 to 180 degrees", row.numbers[0])
                             : fmt::format("a distance of {:g} nm, expected 0 or more", row.numbers[0]));
  }

  void check_spacing() const {
    const std::size_t last = rows_.size() - 1;
    const double spacing = (at(last) - at(0)) / static_cast<double>(last);
    if (!(spacing > 0)) refuse(rows_[last].line, "the table does not rise from its first row to its last");
    for (std::size_t k = 1; k < last; ++k)
      if (const double even = at(0) + static_cast<double>(k) * spacing;
          !(std::abs(at(k) - even) <= kUneven * spacing))
        refuse(rows_[k].line,
               fmt::format("{:g} {}, expected {:.6g}: rows at equal spacing, {:.6g} from one to the next",
                           at(k), unit(), even, spacing));
  }

  void check_forces() const {
    const double third = (at(2) - at(0)) / 6;
    for (std::size_t k = 1; k + 1 < rows_.size(); ++k) {
      const double rise = energy(k + 1) - energy(k - 1);
      const double work = third * (force(k - 1) + 4 * force(k) + force(k + 1));
      const double about = third * (std::abs(force(k - 1)) + 4 * std::abs(force(k)) + std::abs(force(k + 1)));
      if (std::abs(rise + work) <= kSlopeError * about + kEnergyError) continue;
      refuse(rows_[k].line,
             fmt::format(
                 "the forces around {:g} {} are not −dE/d{} of the energies: these change by {:.4g} kJ/mol "
                 "over two rows, by the forces it is {:.4g}; give forces in kJ/mol/{}, rows that are nearer "
                 "each other, or energies alone",
                 at(k), unit(), of_ == TableOf::kAngle ? "θ" : "r", rise, -work,
                 of_ == TableOf::kAngle ? "degree" : "nm"));
    }
  }

  std::string name_;
  TableOf of_;
  std::vector<TableRow> rows_;
};

}  // namespace

std::shared_ptr<const Spline> read_energy_table(const std::filesystem::path& file, TableOf of) {
  return TableFile(file, of).spline();
}

std::shared_ptr<const Spline> read_energy_table(const TomlTable& keys, const char* key,
                                                const std::filesystem::path& file, TableOf of) {
  try {
    return read_energy_table(file, of);
  } catch (const InputError& e) {
    keys.fail(key, e.what());
  }
}

namespace {

void read_one(const TomlTable& keys, const Units& units, Terms& terms) {
  RowReader rows(keys, units);
  const auto bonds = rows.pairs("bonds", 0, "pairs of atoms [i, j] that have the file's energies of r");
  const auto angles = rows.read("angles", 3, 0, "atoms [i, j, k] that have the file's energies of θ, at j");
  const auto file = keys.get<std::filesystem::path>(
      "file", "rows of r in nm or θ in °, energy in kJ/mol and perhaps the force, at equal spacing");
  keys.reject_unknown();
  if (keys.describing()) return;
  if (bonds.empty() == angles.empty())
    keys.fail("file", "expected bonds = [[0, 1]] or angles = [[0, 1, 2]] beside it, one of the two");
  const auto energy =
      read_energy_table(keys, "file", file, angles.empty() ? TableOf::kDistance : TableOf::kAngle);
  for (const Row& row : bonds) terms.tabulated_bonds.push_back({row.atom[0], row.atom[1], energy});
  for (const Row& row : angles)
    terms.tabulated_angles.push_back({row.atom[0], row.atom[1], row.atom[2], energy});
}

}  // namespace

void read_tables(const TomlTable& keys, const Units& units, Terms& terms) {
  const std::size_t count = keys.size(
      "tables", "energies by tables, {file = \"bond.csv\", bonds = [[0, 1]]} or with angles = [[0, 1, 2]]");
  if (keys.describing()) return read_one(keys.section("tables"), units, terms);
  for (std::size_t k = 0; k < count; ++k) read_one(keys.section("tables", k), units, terms);
}

}  // namespace taut
