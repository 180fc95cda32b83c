#include "systems/builders/named_atoms.hpp"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <set>

#include "base/nearest_name.hpp"

namespace taut {
namespace {

std::optional<int> whole_number(std::string_view text) {
  int number = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  return read.ec == std::errc() && read.ptr == text.data() + text.size() ? std::optional(number)
                                                                         : std::nullopt;
}

// Adds the atoms that one word names: "7", "-1", the span "10-29", or all atoms of a name.
void add_atoms(const std::string& word, const Scene& scene, std::vector<int>& atoms) {
  const int all = scene.system.atoms();
  const auto expect_there = [&](int a) {
    if (a < 0 || a >= all) throw InputError(fmt::format("there is no atom {}, only 0 to {}", word, all - 1));
    return a;
  };
  if (const auto one = whole_number(word)) {
    atoms.push_back(expect_there(*one < 0 ? *one + all : *one));
    return;
  }
  const std::size_t dash = word.find('-');
  const auto first = whole_number(word.substr(0, dash));
  if (const auto last = dash == word.npos ? std::nullopt : whole_number(word.substr(dash + 1));
      first && last) {
    if (*last < *first) throw InputError(fmt::format("\"{}\": expected a span, as \"10-29\"", word));
    for (int a = expect_there(*first); a <= expect_there(*last); ++a) atoms.push_back(a);
    return;
  }
  std::set<std::string_view> seen;
  const std::size_t before = atoms.size();
  for (int a = 0; a < all; ++a) {
    const std::string& name = scene.names.kinds[scene.names.kind[a]].atom;
    seen.insert(name);
    if (name == word) atoms.push_back(a);
  }
  if (atoms.size() == before)
    throw InputError(fmt::format("no atom is called \"{}\"{}", one_line(word),
                                 did_you_mean(word, {seen.begin(), seen.end()})));
}

}  // namespace

std::vector<int> read_named_atoms(const TomlTable& keys, std::string_view key, std::size_t row,
                                  const Scene& scene) {
  std::vector<int> atoms;
  for (const std::string& word : keys.words(key, row)) {
    try {
      add_atoms(word, scene, atoms);
    } catch (const InputError& e) {
      keys.fail(key, row, e.what());
    }
  }
  return atoms;
}

}  // namespace taut
