#pragma once

// TOML tables with typed getters, whose errors say where: "water.toml:12: run.dt_fs: expected a number,
// got a string". A value laid over the file by an override is named by it: "--set run.dt_fs=abc: ...".

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
#include "systems/keys.hpp"

namespace taut {

// An error that already says where.
struct LocatedError : InputError {
  using InputError::InputError;
};

struct Columns {  // how many numbers a row may have
  std::size_t min, max;
};

class TomlTable {
 public:
  // The root. `where` names the file, or what stands for one; `keys` takes what is read.
  TomlTable(const toml::table& table, std::string where, KeysRead* keys = nullptr)
      : TomlTable(table, "", std::move(where), keys) {}
  TomlTable(const TomlTable&) = delete;  // keeps track of the keys asked for: one table, one track
  TomlTable& operator=(const TomlTable&) = delete;

  bool has(std::string_view key) const { return find(key) != nullptr; }
  TomlTable section(std::string_view key) const;  // empty if it is not there
  std::vector<std::string> keys() const;

  // An array whose elements are sections, [[place]], or words: how many there are, 0 if it is not there; one
  // of them; the word where it is one.
  std::size_t size(std::string_view key, const About& about = {}) const;
  TomlTable section(std::string_view key, std::size_t k) const;
  std::optional<std::string> word(std::string_view key, std::size_t k) const;

  bool describing() const { return keys_ && keys_->describing; }

  // Reads a key into a variable, which keeps its value where there is no such key. Whether there is.
  template <class T>
  bool read(std::string_view key, T& into, const About& about = {}) const {
    const bool there = fetch(key, into, about);
    note(key, into, about);
    return there;
  }
  bool read(std::string_view key, Rows& into, Columns columns, const About& about = {}) const;

  // The same for a key that must be there.
  template <class T>
  T get(std::string_view key, const About& about = {}) const {
    T value{};
    if (!read(key, value, about)) missing(key);
    return value;
  }
  Rows get_rows(std::string_view key, Columns columns, const About& about = {}) const;

  // One of several words, that must be there.
  std::string choice(std::string_view key, const std::vector<std::string_view>& words,
                     const char* meaning = "") const;

  // Throws LocatedError where a key is there that nothing reads: it counts only `where` something is said.
  //     table.counts("friction_per_ps", run.langevin(), "with run.thermostat = \"langevin\"");
  void counts(std::string_view key, bool read, std::string_view where) const;
  void anew(std::string_view but) const;  // what was read of this section before counts no more, but one key
  bool overridden(std::string_view key) const;  // an override says it, not the file

  // Throws LocatedError at a key, or at one row of its array.
  [[noreturn]] void fail(std::string_view key, const std::string& message) const;
  [[noreturn]] void fail(std::string_view key, std::size_t row, const std::string& message) const;

  // Throws LocatedError where one of these keys is there, which are another's: nobody is pointed to them.
  void refuse(std::initializer_list<std::string_view> keys, const char* message) const;

  // Throws LocatedError for a key nobody asked for, with the nearest one that was.
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
  bool fetch(std::string_view key, std::vector<double>& into, const About&) const;  // finite ones
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
  void note(std::string_view key, const T& value, const About& about) const {
    if (keys_) note(key, about, type_text<T>(), value_text(value));
  }
  void note(std::string_view key, const About& about, const char* type, std::string value) const;

  const toml::node* find(std::string_view key) const;
  std::optional<std::int64_t> integer(std::string_view key, Range range) const;
  std::string full(std::string_view key) const;  // "run.dt_fs"
  std::string place(const toml::node* node) const;
  void missing(std::string_view key) const;  // throws, but where keys are only described
  [[noreturn]] void wrong_type(std::string_view key, const toml::node& got, const char* expected) const;
  double checked(std::string_view key, double value, Range range) const;

  const toml::table& table_;
  std::string name_;   // "run"; empty: the root
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

// What stands before an override where files have their name and line.
inline constexpr std::string_view kOverride = "--set ";

std::string one_line(std::string_view text);     // control characters become spaces
std::string value_text(const toml::node& node);  // as TOML has it, in one line whatever its length

// A path is relative to the file that says it, in an override to the current folder.
std::filesystem::path path_of(const toml::value<std::string>& name);

toml::table parse_toml_file(const std::filesystem::path& file);
toml::table parse_toml_text(std::string_view text, const std::filesystem::path& file);  // named in errors

// "run.dt_fs=2": a dotted key and a value, as in TOML, but a word needs no quotes.
toml::table parse_overrides(const std::vector<std::string>& overrides);

// The overrides key by key, "run.dt_fs" to "2", the later over those before, values as TOML in one line; and
// back.
using KeyValues = std::map<std::string, std::string>;
KeyValues key_values(const std::vector<std::string>& overrides);
std::vector<std::string> overrides_of(const KeyValues& values);

std::string toml_quoted(std::string_view text);  // a string as TOML has it, in one line

// The tables' keys together; where both have one, the upper's counts. A table over an array has keys of its
// elements, by their numbers. Throws LocatedError where there is none.
void lay_over(toml::table& base, toml::table&& upper);

}  // namespace taut
