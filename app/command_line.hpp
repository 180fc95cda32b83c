#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <vector>

namespace taut {

// Returns a word as a shell takes it, in quotes only if necessary.
std::string quoted_for_shell(const std::string& word);

// Collects a command line in the form that a shell takes,
//     taut chart water --set run.seed=7
// without options that were not given.
class CommandLine {
 public:
  CommandLine(const char* subcommand, const std::string& scene);

  void option(const char* name, const std::vector<std::string>& values);
  void option(const char* name, const std::vector<double>& values);
  template <class T>
  void option(const char* name, const std::optional<T>& value) {
    if (value) option(name, std::vector{fmt::format("{}", *value)});
  }
  void flag(const char* name, bool given);
  const std::string& text() const { return text_; }

 private:
  std::string text_ = "taut";
};

// A flag that stands for a key of the scene: --dt-fs 2 for run.dt_fs=2.
struct KeyFlag {
  template <class T>
  KeyFlag(const char* flag, const char* key, const std::optional<T>& value)
      : said(value ? fmt::format("{} {}", flag, *value) : ""),
        override_(value ? fmt::format("{}={}", key, *value) : "") {}

  // One of several keys that a flag stands for.
  KeyFlag(std::string flag, std::string key_and_value)
      : said(std::move(flag)), override_(std::move(key_and_value)) {}

  // Replaces the override in an error message by the flag: "--set run.dt_fs=-2: run.dt_fs: …" becomes
  // "--dt-fs -2: …".
  std::string replace_by_flag(const std::string& message) const;

  std::string said, override_;  // empty if the flag was not given
};

// Returns all overrides of a command line. Throws InputError for a key with two values.
std::vector<std::string> collect_overrides(const std::vector<KeyFlag>& flags,
                                           const std::vector<std::string>& settings);

}  // namespace taut
