#include <fmt/format.h>

#include "commands.hpp"
#include "constraints/methods.hpp"
#include "systems/scene_file.hpp"

namespace taut {
namespace {

void print_methods() {
  for (const MethodEntry& method : methods()) {
    fmt::print("{:<11} {}\n", method.name, method.summary);
    MethodOptions defaults(method);
    for (const Option& option : defaults.describe())
      fmt::print("{:11}   {}\n", "", option.in_words());
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
