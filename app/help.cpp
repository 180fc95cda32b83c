#include "help.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/errors.hpp"
#include "base/nearest_name.hpp"
#include "base/words.hpp"
#include "commands.hpp"
#include "printing.hpp"
#include "systems/builders/builders.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut {
namespace {

// "run.dt_fs = 1 fs", "build.molecules (required)".
std::string head_of(const Key& key) {
  const std::string unit = *key.about.unit ? fmt::format(" {}", key.about.unit) : "";
  if (key.required) return fmt::format("{} (required{})", key.name(), unit.empty() ? "" : "," + unit);
  if (key.value.empty()) return key.name() + (unit.empty() ? "" : fmt::format(" ({})", unit.substr(1)));
  return fmt::format("{} = {}{}", key.name(), key.value, unit);
}

// The kinds or methods that a key is of, where its section does not say so: [molecule], [place] are of molecules.
std::string whose(const Key& key) {
  const bool method = key.section == "method", shared = key.section == "build" || key.section == "forcefield";
  const bool every = !method && key.kinds.size() == kinds().size();
  const bool said = !method && !shared && key.kinds.size() == 1;
  if (key.kinds.empty() || every || said) return "";
  const char* of = method ? "" : "kind ";
  return fmt::format("; of {}{}", of, fmt::join(key.kinds, ", "));
}

// "length of a step; number, more than 0".
std::string sentence(const Key& key) {
  const std::string allowed = key.allowed();
  std::string text = key.about.meaning;
  text += fmt::format("; {}", key.about.words.empty() ? key.type : allowed);
  if (key.about.words.empty() && !allowed.empty()) text += ", " + allowed;
  if (!key.counts_only.empty()) text += "; counts only " + key.counts_only;
  return text + whose(key);
}

// Returns the general form of a key of a scene: molecule.NAME.units for molecule.decane.units, place.count
// for place.0.count.
std::string described(const std::string& name) {
  std::istringstream words(name);
  std::vector<std::string> path;
  for (std::string word; std::getline(words, word, '.');)
    if (word.find_first_not_of("0123456789") != word.npos) path.push_back(word);
  if (!path.empty() && (path[0] == "molecule" || path[0] == "atom")) {
    path.resize(std::max<std::size_t>(path.size(), 2));
    path[1] = "NAME";
  }
  return fmt::format("{}", fmt::join(path, "."));
}

// Returns the keys that a name means: one key, all keys of a section, or those of a kind or method
// ("build.water").
std::vector<Key> keys_named(const std::string& name, const std::vector<Key>& all) {
  std::vector<Key> found;
  const auto dot = name.find('.');
  for (const Key& key : all) {
    const bool of_kind = dot != name.npos && std::ranges::count(key.kinds, name.substr(dot + 1)) > 0 &&
                         (key.section == name.substr(0, dot));
    if (key.name() == name || key.section == name || of_kind) found.push_back(key);
  }
  return found;
}

// True if the text occurs at the beginning of a word.
bool speaks_of(std::string_view text, const std::string& word) {
  const auto letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  for (auto at = text.find(word); at != text.npos; at = text.find(word, at + 1))
    if (at == 0 || !letter(text[at - 1])) return true;
  return false;
}

// Returns, for a name that is no key, the keys whose description contains it ("rope"), or those of a kind or
// method ("water").
std::vector<Key> keys_about(const std::string& word, const std::vector<Key>& all) {
  std::vector<Key> found;
  for (const Key& key : all)
    if (speaks_of(key.name(), word) || speaks_of(key.about.meaning, word) ||
        std::ranges::count(key.kinds, word) + std::ranges::count(key.about.words, word) > 0)
      found.push_back(key);
  return found;
}

// "atom, molecule, place, ...": the sections as `taut help` takes them.
std::string sections() {
  std::vector<std::string_view> names;
  for (const std::string_view section : kSections)
    if (const auto name = section.substr(0, section.find('.'));
        !name.empty() && (names.empty() || names.back() != name))
      names.push_back(name);
  return fmt::format("{}", fmt::join(names, ", "));
}

[[noreturn]] void refuse(const std::string& name, const std::vector<Key>& all) {
  std::set<std::string> names;
  for (const Key& key : all) {
    names.insert({key.name(), key.section});
    for (const auto& kind : key.kinds) names.insert(key.section + "." + kind);
  }
  names.erase("");
  const std::string meant(nearest_name(name, {names.begin(), names.end()}));
  throw InputError(fmt::format(
      "there is no key and no section \"{}\"{}", name,
      meant.empty() ? "; sections: " + sections() : fmt::format("; did you mean \"{}\"?", meant)));
}

struct HelpArguments {
  std::vector<std::string> names;
  bool page = false, list = false;
};

void help(const HelpArguments& arguments, const Commands& commands) {
  const std::vector<Key> all = every_key();
  if (arguments.page) return say_text(keys_page(all));
  if (arguments.list) {
    std::set<std::string> names;
    for (const Key& key : all) names.insert(key.name());
    return say("{}\n", fmt::join(names, "\n"));
  }
  if (arguments.names.empty() && !json_alone())
    return say(
        "{}\n{}\n", commands.help(""),
        wrapped("`taut help KEY` explains a key of a scene, such as run.dt_fs, or a section of them: " +
                    sections() + "; build.water, method.rattle",
                terminal_width(), 0));
  std::vector<Key> keys;
  for (const std::string& name : arguments.names) {
    std::vector<Key> named = keys_named(described(name), all);
    const std::string command = named.empty() ? commands.help(name) : "";
    say_text(command);
    if (named.empty() && command.empty()) named = keys_about(name, all);
    if (named.empty() && command.empty()) refuse(name, all);
    std::ranges::copy(named, std::back_inserter(keys));
  }
  if (json_alone()) {
    auto json = nlohmann::ordered_json::array();
    for (const Key& key : arguments.names.empty() ? all : keys) json.push_back(key_json(key));
    return write_json(json);
  }
  for (const Key& key : keys) say_text(key_text(key, terminal_width()));
  if (std::ranges::count(arguments.names, "run")) say("(the command: taut run --help)\n");
}

}  // namespace

std::string key_text(const Key& key, int width) {
  return fmt::format("{}\n    {}\n", head_of(key), wrapped(sentence(key), width, 4));
}

nlohmann::ordered_json key_json(const Key& key) {
  nlohmann::ordered_json json = {{"key", key.name()}, {"meaning", key.about.meaning}, {"type", key.type}};
  if (*key.about.unit) json["unit"] = key.about.unit;
  if (!key.value.empty()) json["value"] = key.value;
  if (!key.from.empty()) json["from"] = key.from;
  if (key.required) json["required"] = true;
  if (!key.allowed().empty()) json["allowed"] = key.allowed();
  if (!key.counts_only.empty()) json["counts_only"] = key.counts_only;
  if (!key.kinds.empty()) json["kinds"] = key.kinds;
  return json;
}

std::string keys_page(const std::vector<Key>& keys) {
  std::string page = wrapped("# The keys of a scene\n", 120, 0) + "\n\n" +
                     wrapped(
                         "What `taut help --page` prints: every key of a scene's file, its value where it is "
                         "not said, its unit, "
                         "what it means and what it may be. `--set KEY=VALUE` lays another value over it.",
                         120, 0) +
                     "\n";
  std::string section = "-";
  for (const Key& key : keys) {
    if (key.section != section) {
      section = key.section;
      page += section.empty()      ? "\n## Of the scene\n"
              : section == "start" ? "\n## Of a start, the file that build.start names\n"
                                   : fmt::format("\n## [{}]\n", section);
    }
    page += wrapped(fmt::format("- `{}`: {}", head_of(key), sentence(key)), 120, 2) + "\n";
  }
  return page;
}

void add_help(Commands& commands) {
  auto arguments = std::make_shared<HelpArguments>();
  const Subcommand command = commands.add("help", "explain a key of a scene, a section of them, or a command",
                                          [arguments, &commands] { help(*arguments, commands); });
  command.option("key", arguments->names, "run.dt_fs, run, build.water, method.rattle, or any word: rope")
      .words(0, "KEY");
  command.json("as JSON");
  command.flag("--page", arguments->page, "all of them, in Markdown: systems/KEYS.md");
  command.flag("--names", arguments->list, "their names alone");
}

}  // namespace taut
