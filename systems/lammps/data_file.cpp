#include "systems/lammps/data_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "base/errors.hpp"
#include "base/listen.hpp"

namespace taut {
namespace {

// Sections, and the count that says how many rows they have.
constexpr std::array<std::pair<const char*, const char*>, 13> kSectionsOfData = {
    {{"Masses", "atom types"},
     {"Atoms", "atoms"},
     {"Velocities", "atoms"},
     {"Bonds", "bonds"},
     {"Angles", "angles"},
     {"Dihedrals", "dihedrals"},
     {"Impropers", "impropers"},
     {"Pair Coeffs", "atom types"},
     {"PairIJ Coeffs", ""},
     {"Bond Coeffs", "bond types"},
     {"Angle Coeffs", "angle types"},
     {"Dihedral Coeffs", "dihedral types"},
     {"Improper Coeffs", "improper types"}}};
constexpr std::array kCounts = {"atoms",          "bonds",         "angles",     "dihedrals",
                                "impropers",      "atom types",    "bond types", "angle types",
                                "dihedral types", "improper types"};

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

bool is_number(const std::string& word) {
  return !word.empty() && (std::isdigit(static_cast<unsigned char>(word.back())) || word.back() == '.');
}

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : in_(file) {
    data_.file = file.string();
    if (!std::filesystem::is_regular_file(file) || !in_) throw InputError(data_.file + ": no such file");
  }

  LammpsData read() {
    next();  // the first line is a title
    LammpsData::Section* section = nullptr;
    while (next()) {
      if (words_.empty()) continue;
      if (std::isalpha(static_cast<unsigned char>(words_.front().front())))
        section = &begin_section();
      else if (section)
        section->entries.push_back({line_, words_});
      else
        read_header();
    }
    check();
    return std::move(data_);
  }

 private:
  bool next() {
    std::string text;
    hear_sometimes_();
    if (!std::getline(in_, text)) return false;
    ++line_;
    const auto hash = text.find('#');
    comment_ = hash == text.npos ? std::vector<std::string>{} : words_of(text.substr(hash + 1));
    words_ = words_of(text.substr(0, hash));
    return true;
  }

  LammpsData::Section& begin_section() {
    const std::string name = fmt::format("{}", fmt::join(words_, " "));
    const auto known =
        std::ranges::find(kSectionsOfData, name, [](const auto& one) { return std::string(one.first); });
    if (known == kSectionsOfData.end())
      data_.fail(line_, fmt::format("the section {} is none that taut carries out", name));
    const auto [at, fresh] = data_.sections.try_emplace(name);
    if (!fresh) data_.fail(line_, fmt::format("a second section {}", name));
    if (!comment_.empty()) at->second.style = comment_.front();
    return at->second;
  }

  void read_header() {
    std::vector<std::string> numbers, names;
    for (const std::string& word : words_)
      (names.empty() && is_number(word) ? numbers : names).push_back(word);
    const std::string name = fmt::format("{}", fmt::join(names, " "));
    const LammpsData::Entry entry{line_, words_};
    if (numbers.size() == 1 && std::ranges::find(kCounts, name) != kCounts.end()) {
      const double count = data_.number(entry, 0, "a count");
      if (!(count >= 0 && count <= std::numeric_limits<int>::max() && count == std::floor(count)))
        data_.fail(line_, fmt::format("{} {}, expected a whole number below 2^31", count, name));
      data_.counts[name] = static_cast<long>(count);
      return;
    }
    for (int d = 0; d < 3; ++d)
      if (numbers.size() == 2 && name == fmt::format("{0}lo {0}hi", "xyz"[d])) {
        data_.lower[d] = data_.number(entry, 0, "a bound");
        data_.box.edge[d] = data_.number(entry, 1, "a bound") - data_.lower[d];
        return;
      }
    if (numbers.size() == 3 && name == "xy xz yz") {
      for (int d = 0; d < 3; ++d) data_.box.tilt[d] = data_.number(entry, d, "a tilt");
      return;
    }
    data_.fail(line_,
               fmt::format("\"{}\" is no line of the header that taut carries out", fmt::join(words_, " ")));
  }

  void check() {
    if (data_.count("atoms") == 0) data_.fail(line_, "there are no atoms");
    for (const auto& [name, counted_by] : kSectionsOfData) {
      const auto found = data_.sections.find(name);
      if (found == data_.sections.end() || *counted_by == 0) continue;
      const auto rows = std::ssize(found->second.entries);
      if (rows != data_.count(counted_by))
        data_.fail(line_, fmt::format("{} has {} rows, expected {}, the number of {}", name, rows,
                                      data_.count(counted_by), counted_by));
    }
    for (const char* needed : {"Masses", "Atoms"})
      if (!data_.sections.contains(needed)) data_.fail(line_, fmt::format("there is no section {}", needed));
    if (const std::string flaw = Box::flaw(data_.box.vectors()); !flaw.empty())
      data_.fail(line_, fmt::format("the box: {}", flaw));
  }

  std::ifstream in_;
  HearSometimes hear_sometimes_;
  std::size_t line_ = 0;
  std::vector<std::string> words_, comment_;
  LammpsData data_;
};

}  // namespace

long LammpsData::count(const std::string& of) const {
  const auto found = counts.find(of);
  return found == counts.end() ? 0 : found->second;
}

const LammpsData::Section& LammpsData::section(const std::string& name) const {
  static const Section kNone;
  const auto found = sections.find(name);
  return found == sections.end() ? kNone : found->second;
}

void LammpsData::fail(std::size_t line, const std::string& message) const {
  throw InputError(fmt::format("{}:{}: {}", file, line, message));
}

double LammpsData::number(const Entry& entry, std::size_t at, const char* what) const {
  if (at >= entry.words.size())
    fail(entry.line, fmt::format("expected {} as number {} of the row", what, at + 1));
  const std::string& text = entry.words[at];
  double value = 0;
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    fail(entry.line, fmt::format("expected {}, got \"{}\"", what, text));
  return value;
}

int LammpsData::index(const Entry& entry, std::size_t at, const char* what, long most) const {
  const double value = number(entry, at, what);
  if (!(value >= 1 && value <= static_cast<double>(most) && value == std::floor(value)))
    fail(entry.line, fmt::format("expected {} from 1 to {}, got {}", what, most, entry.words[at]));
  return static_cast<int>(value);
}

LammpsData read_lammps_data(const std::filesystem::path& file) {
  return Reader(file).read();
}

}  // namespace taut
