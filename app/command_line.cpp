#include "command_line.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace taut {

// Within single quotes a shell takes all as it is, but for a single quote.
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
  text_ += fmt::format(" {} {}", subcommand, quoted_for_shell(scene));
}

void CommandLine::option(const char* name, const std::vector<std::string>& values) {
  flag(name, !values.empty());
  for (const auto& value : values) text_ += fmt::format(" {}", quoted_for_shell(value));
}

void CommandLine::flag(const char* name, bool given) {
  if (given) text_ += fmt::format(" {}", name);
}

}  // namespace taut
