#include <fmt/format.h>

#include "commands.hpp"
#include "constraints/methods.hpp"
#include "systems/scene_file.hpp"

namespace taut {
namespace {

std::string shown(double value) {
  return fmt::format("{:g}", value);
}
std::string shown(int value) {
  return fmt::format("{}", value);
}
std::string shown(bool value) {
  return value ? "true" : "false";
}
std::string shown(const std::string& value) {
  return fmt::format("\"{}\"", value);
}
std::string shown(const std::optional<double>& value) {
  return value ? shown(*value) : "not set";
}

void print_methods() {
  for (const std::string_view name : method_names()) {
    fmt::print("{:<11} {}\n", name, method_summary(name));
    std::visit(
        [](auto options) {
          options.describe([](const char* key, const auto& value, const char* meaning, Counts = {}) {
            fmt::print("{:11}   {} = {}: {}\n", "", key, shown(value), meaning);
          });
        },
        default_options(name));
  }
}

void print_scenes() {
  for (const auto& [name, hard_on] : list_scenes()) fmt::print("{:<15} {}\n", name, hard_on);
}

}  // namespace

void add_lists(Commands& commands) {
  commands.add("methods", "list the constraint methods and their settings", print_methods);
  commands.add("scenes", "list the scenes, with what each is hard on", print_scenes);
}

}  // namespace taut
