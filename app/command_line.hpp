#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <vector>

namespace taut {

// In quotes only where it has to be.
std::string quoted_for_shell(const std::string& word);

// What was asked for, as a shell takes it,
//     taut chart water --set run.seed=7
// without the options that were not given.
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

// A flag that is short for a key of the scene: --dt-fs 2 for run.dt_fs=2.
struct KeyFlag {
  template <class T>
  KeyFlag(const char* flag, const char* key, const std::optional<T>& value)
      : said(value ? fmt::format("{} {}", flag, *value) : ""),
        override_(value ? fmt::format("{}={}", key, *value) : "") {}

  // What blames the override, by what was typed: "--set run.dt_fs=-2: run.dt_fs: …" becomes "--dt-fs -2: …".
  std::string blamed(const std::string& message) const;

  std::string said, override_;  // empty: it was not given
};

// All overrides of a command line. Throws InputError for a key that it gives two values.
std::vector<std::string> overrides_said(const std::vector<KeyFlag>& flags,
                                        const std::vector<std::string>& settings);

}  // namespace taut
