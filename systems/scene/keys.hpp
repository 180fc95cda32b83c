#pragma once

#include <concepts>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/course.hpp"
#include "base/range.hpp"
#include "base/vectors.hpp"

namespace taut {

// Rows of numbers, e.g. [[1, 2, 3], [4, 5, 6]].
using Rows = std::vector<std::vector<double>>;

// The description of a key of a scene: meaning, unit and allowed values. It is given once, where the key is
// read:
//     table.read("dt_fs", run.dt_fs, {"length of a step", "fs", kPositive});
struct About {
  About() = default;
  About(Range only) : range(only) {}
  About(const char* meant, const char* in = "", Range allowed = kAnyNumber)
      : meaning(meant), unit(in), range(allowed) {}
  About(const char* meant, Range allowed) : meaning(meant), range(allowed) {}
  About(const char* meant, const std::vector<std::string_view>& allowed)
      : meaning(meant), words(allowed.begin(), allowed.end()) {}

  const char* meaning = "";
  const char* unit = "";
  Range range = kAnyNumber;
  std::vector<std::string> words{};  // the allowed values of a text
};

// A key that was read, with its value and description.
struct Key {
  std::string section, key;          // "run", "dt_fs"
  std::vector<std::string> kinds{};  // for every_key(): kinds of [build] or methods that have it
  About about{};
  std::string type{};         // "number", "path", …
  std::string value{};        // the value in effect, in TOML; empty if there is none
  std::string from{};         // its source, "water.toml:12" or "--set run.dt_fs=2"; empty for a default
  std::string counts_only{};  // "with run.thermostat = \"langevin\""
  bool read = false, required = false, idle = false;  // idle: without effect, given the other keys

  std::string name() const { return section.empty() ? key : section + "." + key; }
  bool described_as(const Key& other) const;
  std::string allowed() const;  // "more than 0", "one of dcd, h5md, both"; empty if anything is allowed
};

// All keys that were read, in the order of reading.
struct KeysRead {
  // True while empty tables are read for the descriptions of their keys only: no key is missing then, and
  // readers return before they build anything.
  bool describing = false;
  std::vector<Key> all{};

  Key& of(std::string_view section, std::string_view key);
};

// Returns a value as TOML text; of several rows only their number.
std::string value_text(double value);
std::string value_text(bool value);
std::string value_text(const std::string& value);
std::string value_text(const std::filesystem::path& value);
std::string value_text(const Vec3& value);
std::string value_text(const std::vector<double>& value);
std::string value_text(const Rows& value);
std::string value_text(const Course& value);
template <std::integral Integer>
std::string value_text(Integer value) {
  return std::to_string(value);
}
template <class T>
std::string value_text(const std::optional<T>& value) {
  return value ? value_text(*value) : "";
}

template <class T>
constexpr const char* type_text() {
  if constexpr (std::is_same_v<T, bool>) return "true or false";
  if constexpr (std::is_integral_v<T> || std::is_same_v<T, std::optional<long>>) return "whole number";
  if constexpr (std::is_same_v<T, std::string>) return "text";
  if constexpr (std::is_same_v<T, std::filesystem::path>) return "file";
  if constexpr (std::is_same_v<T, Vec3> || std::is_same_v<T, std::optional<Vec3>>) return "three numbers";
  if constexpr (std::is_same_v<T, std::vector<double>>) return "numbers";
  if constexpr (std::is_same_v<T, Rows>) return "rows of numbers";
  if constexpr (std::is_same_v<T, Course>) return "number or rows [ps, number]";
  return "number";
}

}  // namespace taut
