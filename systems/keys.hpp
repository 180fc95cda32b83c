#pragma once

#include <concepts>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/range.hpp"
#include "base/vectors.hpp"

namespace taut {

// Rows of numbers, [[1, 2, 3], [4, 5, 6]].
using Rows = std::vector<std::vector<double>>;

// What there is to know of a key of a scene, said once, where it is read:
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
  std::vector<std::string> words{};  // a text is one of them
};

// A key that was read.
struct Key {
  std::string section, key;          // "run", "dt_fs"
  std::vector<std::string> kinds{};  // of every_key(): the kinds of [build] or the methods that have it
  About about{};
  std::string type{};         // "number", "path", …
  std::string value{};        // in force, as TOML has it; empty: none
  std::string from{};         // who says so, "water.toml:12" or "--set run.dt_fs=2"; empty: its default
  std::string counts_only{};  // "with run.thermostat = \"langevin\""
  bool read = false, required = false, idle = false;  // idle: of no effect beside the others

  std::string name() const { return section.empty() ? key : section + "." + key; }
  bool described_as(const Key& other) const;
  std::string allowed() const;  // "more than 0", "one of dcd, h5md, both"; empty: anything
};

// The keys that were read, in that order.
struct KeysRead {
  // Tables without keys are read for their descriptions: no key is missing, readers return before they build.
  bool describing = false;
  std::vector<Key> all{};

  Key& of(std::string_view section, std::string_view key);
  void forget(std::string_view section, std::string_view but);
};

// As TOML has them, several rows by their number.
std::string value_text(double value);
std::string value_text(bool value);
std::string value_text(const std::string& value);
std::string value_text(const std::filesystem::path& value);
std::string value_text(const Vec3& value);
std::string value_text(const std::vector<double>& value);
std::string value_text(const Rows& value);
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
  return "number";
}

}  // namespace taut
