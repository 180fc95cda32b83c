#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "base/words.hpp"
#include "commands.hpp"
#include "constraints/registry.hpp"
#include "printing.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut {
namespace {

using nlohmann::ordered_json;

struct ListArguments {
  std::string name;
  bool names = false;
};

ordered_json as_json(const MethodEntry& method) {
  ordered_json options = ordered_json::array();
  MethodOptions defaults(method);
  for (const Option& option : defaults.describe())
    options.push_back({{"key", option.key},
                       {"value", option.value()},
                       {"meaning", option.meaning},
                       {"unit", option.about.unit}});
  return {{"name", method.name}, {"summary", method.summary}, {"options", options}};
}

void print(const MethodEntry& method) {
  constexpr int kName = 12;
  say("{:<11} {}\n", method.name, wrapped(std::string(method.summary), terminal_width(), kName));
  MethodOptions defaults(method);
  for (const Option& option : defaults.describe())
    say("{:{}}  {}\n", "", kName, wrapped(option.in_words(), terminal_width(), kName + 4));
}

void print_methods(const ListArguments& arguments) {
  std::vector<const MethodEntry*> listed;
  for (const MethodEntry& method : methods())
    if (arguments.name.empty() || method.name == arguments.name) listed.push_back(&method);
  if (listed.empty()) listed.push_back(&method_named(arguments.name));  // throws with the nearest name
  ordered_json json = ordered_json::array();
  for (const MethodEntry* method : listed) {
    if (json_alone())
      json.push_back(as_json(*method));
    else if (arguments.names)
      say("{}\n", method->name);
    else
      print(*method);
  }
  if (json_alone()) write_json(json);
}

void print_scenes(const ListArguments& arguments) {
  ordered_json json = ordered_json::array();
  for (const SceneFolder& folder : scene_folders()) {
    std::vector<std::vector<std::string>> rows;
    for (const auto& [name, hard_on] : list_scenes(folder.path)) {
      json.push_back({{"name", name}, {"hard_on", hard_on}, {"among", folder.title}});
      if (arguments.names) say("{}\n", name);
      rows.push_back({name, hard_on});
    }
    if (arguments.names || json_alone()) continue;
    if (*folder.title) say("\n{}:\n", folder.title);
    say_text(table_text(rows, terminal_width()));
  }
  if (json_alone()) write_json(json);
}

}  // namespace

void add_lists(Commands& commands) {
  auto of_methods = std::make_shared<ListArguments>();
  const Subcommand methods_command = commands.add("methods", "list the constraint methods and their settings",
                                                  [of_methods] { print_methods(*of_methods); });
  methods_command.option("method", of_methods->name, "one alone").words(0, "METHOD");
  methods_command.json("as JSON");
  methods_command.flag("--names", of_methods->names, "their names alone");
  auto of_scenes = std::make_shared<ListArguments>();
  const Subcommand scenes_command = commands.add("scenes", "list the scenes, with what each is hard on",
                                                 [of_scenes] { print_scenes(*of_scenes); });
  scenes_command.json("as JSON");
  scenes_command.flag("--names", of_scenes->names, "their names alone");
}

}  // namespace taut
