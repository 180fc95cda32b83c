#pragma once

// TOML tables with typed getters. Their errors give the location: "water.toml:12: run.dt_fs: expected a
// number, got a string"; for a value from an override, "--set run.dt_fs=abc: ...".

#include <toml++/toml.h>

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/errors.hpp"
#include "base/range.hpp"
#include "base/vectors.hpp"
#include "systems/scene/keys.hpp"

namespace taut {

// An error whose message has its location already.
struct LocatedError : InputError {
  using InputError::InputError;
};

struct Columns {  // how many numbers a row may have
  std::size_t min, max;
};

class TomlTable {
 public:
  // The root table. `where` is the file's name for messages; `keys` receives every key that is read.
  TomlTable(const toml::table& table, std::string where, KeysRead* keys = nullptr)
      : TomlTable(table, "", std::move(where), keys) {}
  TomlTable(const TomlTable&) = delete;  // it records which keys were requested
  TomlTable& operator=(const TomlTable&) = delete;

  bool has(std::string_view key) const { return find(key) != nullptr; }
  TomlTable section(std::string_view key) const;  // an empty one if there is none
  std::vector<std::string> keys() const;

  // For an array of sections, [[place]], or words: returns its size (0 if it does not exist), element k as a
  // section, and element k as a word if it is one.
  std::size_t size(std::string_view key, const About& about = {}) const;
  TomlTable section(std::string_view key, std::size_t k) const;
  std::optional<std::string> word(std::string_view key, std::size_t k) const;
  // Element k as words, if it is a word, a whole number or a list of these.
  std::vector<std::string> words(std::string_view key, std::size_t k) const;

  bool describing() const { return keys_ && keys_->describing; }

  // Reads a key into a variable, which keeps its value if the key does not exist. Returns whether it exists.
  template <class T>
  bool read(std::string_view key, T& into, const About& about = {}) const {
    const bool there = fetch(key, into, about);
    record(key, into, about);
    return there;
  }
  bool read(std::string_view key, Rows& into, Columns columns, const About& about = {}) const;

  // Returns the value of a key that must exist.
  template <class T>
  T get(std::string_view key, const About& about = {}) const {
    T value{};
    if (!read(key, value, about)) missing(key);
    return value;
  }
  Rows get_rows(std::string_view key, Columns columns, const About& about = {}) const;

  // Returns the value of a key that must exist and be one of these words.
  std::string choice(std::string_view key, const std::vector<std::string_view>& words,
                     const char* meaning = "") const;

  // Throws LocatedError if the key exists but has no effect; `where` says in which case it has one:
  //     table.require_effect("friction_per_ps", run.langevin(), "with run.thermostat = \"langevin\"", {"thermostat"});
  // A key of the file is set aside instead where an override has changed one of those that decide on it.
  void require_effect(std::string_view key, bool read, std::string_view where,
                      const std::vector<std::string_view>& decided_by = {}) const;
  bool overridden(std::string_view key) const;  // whether its value comes from an override

  // Throws LocatedError with the location of a key, or of one row of its array.
  [[noreturn]] void fail(std::string_view key, const std::string& message) const;
  [[noreturn]] void fail(std::string_view key, std::size_t row, const std::string& message) const;

  // Throws LocatedError if one of these keys exists, which belong elsewhere; they are never suggested.
  void refuse(std::initializer_list<std::string_view> keys, const char* message) const;

  // Throws LocatedError for a key that was never requested, with the nearest one that was.
  void reject_unknown() const;

 private:
  TomlTable(const toml::table& table, std::string name, std::string where, KeysRead* keys)
      : table_(table), name_(std::move(name)), where_(std::move(where)), keys_(keys) {}

  bool fetch(std::string_view key, double& into, const About& about) const;
  bool fetch(std::string_view key, bool& into, const About&) const;
  bool fetch(std::string_view key, std::string& into, const About& about) const;
  // A path is relative to the file that says it, in an override to the current folder.
  bool fetch(std::string_view key, std::filesystem::path& into, const About&) const;
  bool fetch(std::string_view key, Vec3& into, const About&) const;
  bool fetch(std::string_view key, std::vector<double>& into, const About&) const;  // finite numbers only
  bool fetch(std::string_view key, Course& into, const About& about) const;  // a lone number is one point
  template <class T>
  bool fetch(std::string_view key, std::optional<T>& into, const About& about) const {
    T value{};
    if (!fetch(key, value, about)) return false;
    into = value;
    return true;
  }
  template <std::integral Integer>
  bool fetch(std::string_view key, Integer& into, const About& about) const;

  template <class T>
  void record(std::string_view key, const T& value, const About& about) const {
    if (keys_) record(key, about, type_text<T>(), value_text(value));
  }
  void record(std::string_view key, const About& about, const char* type, std::string value) const;

  const toml::node* find(std::string_view key) const;
  std::optional<std::int64_t> integer(std::string_view key, Range range) const;
  std::string full_name(std::string_view key) const;  // "run.dt_fs"
  std::string location_of(const toml::node* node) const;
  void missing(std::string_view key) const;  // throws, unless keys are only described
  [[noreturn]] void wrong_type(std::string_view key, const toml::node& got, const char* expected) const;
  double check_range(std::string_view key, double value, Range range) const;

  const toml::table& table_;
  std::string name_;   // "run"; empty for the root
  std::string where_;  // "water.toml:11"
  KeysRead* keys_;
  mutable std::set<std::string, std::less<>> asked_;
};

template <std::integral Integer>
bool TomlTable::fetch(std::string_view key, Integer& into, const About& about) const {
  const auto value = integer(key, about.range);
  if (value && !std::in_range<Integer>(*value)) fail(key, "out of range");
  if (value) into = static_cast<Integer>(*value);
  return value.has_value();
}

// The prefix of an override in messages, in place of file and line.
inline constexpr std::string_view kOverride = "--set ";
inline bool is_of_override(const toml::node& node) {
  return node.source().path && node.source().path->starts_with(kOverride);
}

std::string one_line(std::string_view text);     // control characters become spaces
std::string value_text(const toml::node& node);  // as TOML text in one line

// A path is relative to the file that says it, in an override to the current folder.
std::filesystem::path path_of(const toml::value<std::string>& name);

toml::table parse_toml_file(const std::filesystem::path& file);
toml::table parse_toml_text(std::string_view text, const std::filesystem::path& file);  // file: for messages

// Parses "run.dt_fs=2", a dotted key and a value as in TOML, except that a word needs no quotes.
toml::table parse_overrides(const std::vector<std::string>& overrides);

// Returns the overrides by key, "run.dt_fs" → "2", where later ones replace earlier ones and values are TOML
// in one line; and the reverse.
using KeyValues = std::map<std::string, std::string>;
KeyValues key_values(const std::vector<std::string>& overrides);
std::vector<std::string> overrides_of(const KeyValues& values);

// A method with its settings is one word, NAME or NAME:KEY=VALUE,KEY=VALUE: "rattle:sweeps=4" returns
// {"method.name=rattle", "method.sweeps=4"}. Throws InputError for settings that are none.
std::vector<std::string> overrides_of_method(const std::string& word);

std::string toml_quoted(std::string_view text);  // a TOML string in one line

// Merges two tables; if both have a key, the upper one's value counts. A table over an array names its
// elements by number. Throws LocatedError for an element that does not exist.
void overwrite(toml::table& base, toml::table&& upper);

}  // namespace taut
