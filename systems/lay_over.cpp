#include <fmt/format.h>

#include <charconv>

#include "systems/toml_reader.hpp"

namespace taut {
namespace {

// Of an array, elements that overrides name by their numbers, counted from 0: place.0.count.
void lay_over_elements(toml::array& base, toml::table&& upper) {
  for (auto&& [name, node] : upper) {
    const std::string_view number = name.str();
    std::size_t k = 0;
    const auto read = std::from_chars(number.begin(), number.end(), k);
    if (read.ec != std::errc() || read.ptr != number.end() || k >= base.size())
      throw LocatedError(fmt::format("{}: there is no {} in a list of {}, counted from 0",
                                     *node.source().path, toml_quoted(number), base.size()));
    if (base[k].is_table() && node.is_table())
      lay_over(*base[k].as_table(), std::move(*node.as_table()));
    else
      node.visit([&](auto& value) {
        base.replace(base.cbegin() + static_cast<std::ptrdiff_t>(k), std::move(value));
      });
  }
}

}  // namespace

void lay_over(toml::table& base, toml::table&& upper) {
  for (auto&& entry : upper) {
    const std::string_view key = entry.first.str();
    toml::node& node = entry.second;
    toml::node* below = base.get(key);
    if (below && below->is_table() && node.is_table())
      lay_over(*below->as_table(), std::move(*node.as_table()));
    else if (below && below->is_array() && node.is_table())
      lay_over_elements(*below->as_array(), std::move(*node.as_table()));
    else  // moved, not copied: a copy forgets where it came from
      node.visit([&](auto& value) { base.insert_or_assign(key, std::move(value)); });
  }
}

}  // namespace taut
