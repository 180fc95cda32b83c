// Overrides such as "run.dt_fs=2": parsing, merging with a file's keys, and writing them out again.
#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <limits>
#include <sstream>

#include "systems/scene/toml_reader.hpp"

namespace taut {
namespace {

// Returns the value with quotes if it is a bare word.
toml::table parse_bare(std::string_view text, std::size_t equals, std::string_view where) {
  std::ostringstream quoted;
  quoted << text.substr(0, equals) << "=" << toml::value<std::string>{std::string(text.substr(equals + 1))};
  return toml::parse(quoted.str(), where);
}

// The limit of TOML's integers.
bool is_too_large(std::string_view value) {
  const auto digits = value.find_first_not_of(" +-");
  return digits != value.npos && value.find_first_not_of("0123456789_ ", digits) == value.npos &&
         value.size() - digits > 18;
}

toml::table parse_override(const std::string& text) {
  const std::string where = one_line(std::string(kOverride) + text);
  const auto equals = text.find('=');
  if (equals != text.npos && text.find_first_of("\n\r") == text.npos) {
    try {
      return toml::parse(text, where);
    } catch (const toml::parse_error&) {
    }
    if (is_too_large(std::string_view(text).substr(equals + 1)))
      throw LocatedError(fmt::format("{}: {}: out of range, expected a whole number of at most {}", where,
                                     text.substr(0, equals), std::numeric_limits<std::int64_t>::max()));
    try {
      return parse_bare(text, equals, where);
    } catch (const toml::parse_error&) {
    }
  }
  throw LocatedError(where + ": expected key=value, such as run.dt_fs=2");
}

void collect(const toml::table& table, const std::string& above, KeyValues& values) {
  for (const auto& [name, node] : table) {
    const std::string key = above + std::string(name.str());
    if (const auto* section = node.as_table())
      collect(*section, key + ".", values);
    else
      values[key] = value_text(node);
  }
}

// Merges overrides into elements of an array, which they name by numbers from 0 on: place.0.count, bonds.0.2.
void overwrite_elements(toml::array& base, toml::table&& upper) {
  for (auto&& [name, node] : upper) {
    const std::string_view number = name.str();
    std::size_t k = 0;
    const auto read = std::from_chars(number.begin(), number.end(), k);
    if (read.ec != std::errc() || read.ptr != number.end() || k >= base.size())
      throw LocatedError(fmt::format("{}: there is no {} in a list of {}, counted from 0",
                                     *node.source().path, toml_quoted(number), base.size()));
    if (base[k].is_table() && node.is_table())
      overwrite(*base[k].as_table(), std::move(*node.as_table()));
    else if (base[k].is_array() && node.is_table())
      overwrite_elements(*base[k].as_array(), std::move(*node.as_table()));
    else
      node.visit([&](auto& value) {
        base.replace(base.cbegin() + static_cast<std::ptrdiff_t>(k), std::move(value));
      });
  }
}

}  // namespace

void overwrite(toml::table& base, toml::table&& upper) {
  for (auto&& entry : upper) {
    const std::string_view key = entry.first.str();
    toml::node& node = entry.second;
    toml::node* below = base.get(key);
    if (below && below->is_table() && node.is_table())
      overwrite(*below->as_table(), std::move(*node.as_table()));
    else if (below && below->is_array() && node.is_table())
      overwrite_elements(*below->as_array(), std::move(*node.as_table()));
    else  // moved, because a copy loses its source location
      node.visit([&](auto& value) { base.insert_or_assign(key, std::move(value)); });
  }
}

toml::table parse_overrides(const std::vector<std::string>& overrides) {
  toml::table all;
  for (const std::string& text : overrides) overwrite(all, parse_override(text));
  return all;
}

KeyValues key_values(const std::vector<std::string>& overrides) {
  KeyValues values;
  collect(parse_overrides(overrides), "", values);
  return values;
}

std::vector<std::string> overrides_of(const KeyValues& values) {
  std::vector<std::string> overrides;
  for (const auto& [key, value] : values) overrides.push_back(key + "=" + value);
  return overrides;
}

std::vector<std::string> overrides_of_method(const std::string& word) {
  const auto colon = word.find(':');
  std::vector<std::string> overrides = {"method.name=" + word.substr(0, colon)};
  if (colon == word.npos) return overrides;
  std::istringstream settings(word.substr(colon + 1) + ",");
  for (std::string setting; std::getline(settings, setting, ',');) {
    const auto equals = setting.find('=');
    if (equals == setting.npos || equals == 0 || setting.starts_with("name="))
      throw InputError(
          fmt::format("{}: \"{}\" is no setting; expected NAME:KEY=VALUE,KEY=VALUE, such as "
                      "rattle:sweeps=4",
                      word, setting));
    overrides.push_back("method." + setting);
  }
  return overrides;
}

}  // namespace taut
