#include "command_line.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <map>
#include <string_view>

#include "base/errors.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {
namespace {

struct Said {
  std::string words, value;
};

// True if two values are equal as texts or as numbers, e.g. 2 and 2.0.
bool same(const std::string& a, const std::string& b) {
  char *end_a = nullptr, *end_b = nullptr;
  const double x = std::strtod(a.c_str(), &end_a), y = std::strtod(b.c_str(), &end_b);
  return a == b || (!a.empty() && !b.empty() && *end_a == 0 && *end_b == 0 && x == y);
}

}  // namespace

// Within single quotes a shell takes every character literally, except a single quote.
std::string quoted_for_shell(const std::string& word) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) || std::string_view("_-./:,=+@%").find(c) != std::string_view::npos || c > 127;
  };
  if (!word.empty() && std::ranges::all_of(word, plain)) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

CommandLine::CommandLine(const char* subcommand, const std::string& scene) {
  text_ += fmt::format(" {}{}", subcommand, scene.empty() ? "" : " " + quoted_for_shell(scene));
}

void CommandLine::option(const char* name, const std::vector<std::string>& values) {
  flag(name, !values.empty());
  for (const auto& value : values) text_ += fmt::format(" {}", quoted_for_shell(value));
}

void CommandLine::option(const char* name, const std::vector<double>& values) {
  flag(name, !values.empty());
  for (const double value : values) text_ += fmt::format(" {}", value);
}

std::vector<std::string> collect_overrides(const std::vector<KeyFlag>& flags,
                                           const std::vector<std::string>& settings) {
  std::vector<std::string> all;
  std::map<std::string, Said> known;
  const auto add = [&](const std::string& override_, const std::string& words) {
    all.push_back(override_);
    for (const auto& [key, value] : key_values({override_})) {
      const auto& [said, is_new] = known.try_emplace(key, Said{words, value});
      if (!same(said->second.value, value))
        throw InputError(
            fmt::format("{} is said twice, as {} and as {}; leave one out", key, said->second.words, words));
    }
  };
  for (const KeyFlag& flag : flags)
    if (!flag.said.empty()) add(flag.override_, flag.said);
  for (const std::string& setting : settings) add(setting, "--set " + setting);
  return all;
}

std::string KeyFlag::replace_by_flag(const std::string& message) const {
  const std::string other =
      fmt::format("--set {}: {}: ", override_, override_.substr(0, override_.find('=')));
  return !said.empty() && message.starts_with(other) ? said + ": " + message.substr(other.size()) : message;
}

void CommandLine::flag(const char* name, bool given) {
  if (given) text_ += fmt::format(" {}", name);
}

}  // namespace taut
