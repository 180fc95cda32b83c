#include "systems/scene/toml_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>

#include "base/nearest_name.hpp"
#include "systems/scene/heard_text.hpp"

namespace taut {
namespace {

const char* type_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a section";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a string";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "a boolean";
    default:
      return "a date or time";
  }
}

std::optional<double> number_of(const toml::node& node) {
  if (node.is_integer()) return static_cast<double>(node.as_integer()->get());
  if (node.is_floating_point()) return node.as_floating_point()->get();
  return {};
}

// Sections are listed with their own keys.
std::string list_text(const toml::array& list) {
  const bool words = std::ranges::none_of(list, [](const toml::node& one) { return one.is_table(); });
  return words ? value_text(list) : fmt::format("{} of them", list.size());
}

}  // namespace

std::string one_line(std::string_view text) {
  std::string line(text);
  for (char& c : line)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return line;
}

std::string value_text(const toml::node& node) {
  if (const auto* string = node.as_string()) return toml_quoted(string->get());
  std::ostringstream text;
  const char* between = "";
  if (const auto* array = node.as_array()) {
    for (const toml::node& one : *array) text << std::exchange(between, ", ") << value_text(one);
    return fmt::format("[{}]", text.str());
  }
  if (const auto* table = node.as_table()) {
    for (const auto& [key, one] : *table)
      text << std::exchange(between, ", ") << toml_quoted(key.str()) << " = " << value_text(one);
    return fmt::format("{{{}}}", text.str());
  }
  if (const auto* number = node.as_floating_point()) {
    const std::string shortest = fmt::format("{}", number->get());
    const bool integer = shortest.find_first_not_of("+-0123456789") == shortest.npos;
    return shortest + (integer ? ".0" : "");  // keeps it a floating-point number
  }
  node.visit([&](const auto& value) { text << value; });
  return text.str();
}

TomlTable TomlTable::section(std::string_view key) const {
  static const toml::table kEmpty;
  const std::string name = full_name(key);
  const toml::node* node = find(key);
  if (!node) return TomlTable(kEmpty, name, where_, keys_);
  if (!node->is_table()) wrong_type(key, *node, "a section");
  return TomlTable(*node->as_table(), name, location_of(node), keys_);
}

std::vector<std::string> TomlTable::keys() const {
  std::vector<std::string> all;
  for (const auto& entry : table_) all.emplace_back(entry.first.str());
  return all;
}

std::size_t TomlTable::size(std::string_view key, const About& about) const {
  const toml::node* node = find(key);
  if (node && node->is_table())
    fail(key, fmt::format("expected a list of sections: write [[{}]]", full_name(key)));
  if (node && !node->is_array()) wrong_type(key, *node, "an array");
  const std::size_t size = node ? node->as_array()->size() : 0;
  if (keys_) record(key, about, "list", size > 0 ? list_text(*node->as_array()) : "");
  return size;
}

TomlTable TomlTable::section(std::string_view key, std::size_t k) const {
  const toml::node& node = (*find(key)->as_array())[k];
  const std::string name = fmt::format("{}.{}", full_name(key), k);
  if (!node.is_table()) fail(key, k, fmt::format("expected a section, got {}", type_name(node)));
  return TomlTable(*node.as_table(), name, location_of(&node), keys_);
}

std::optional<std::string> TomlTable::word(std::string_view key, std::size_t k) const {
  return (*find(key)->as_array())[k].value_exact<std::string>();
}

std::vector<std::string> TomlTable::words(std::string_view key, std::size_t k) const {
  const toml::node& node = (*find(key)->as_array())[k];
  std::vector<std::string> all;
  const auto add = [&](const toml::node& one) {
    if (one.is_string())
      all.push_back(one.as_string()->get());
    else if (one.is_integer())
      all.push_back(std::to_string(one.as_integer()->get()));
    else
      fail(key, k, fmt::format("expected whole numbers and words, got {}", type_name(one)));
  };
  if (const toml::array* list = node.as_array())
    for (const toml::node& one : *list) add(one);
  else
    add(node);
  return all;
}

bool TomlTable::fetch(std::string_view key, double& into, const About& about) const {
  const toml::node* node = find(key);
  if (!node) return false;
  const auto value = number_of(*node);
  if (!value) wrong_type(key, *node, "a number");
  into = check_range(key, *value, about.range);
  return true;
}

bool TomlTable::fetch(std::string_view key, bool& into, const About&) const {
  const toml::node* node = find(key);
  if (!node) return false;
  if (!node->is_boolean()) wrong_type(key, *node, "true or false");
  into = node->as_boolean()->get();
  return true;
}

bool TomlTable::fetch(std::string_view key, std::string& into, const About& about) const {
  const toml::node* node = find(key);
  if (!node) return false;
  if (!node->is_string()) wrong_type(key, *node, "a string");
  const std::string& word = node->as_string()->get();
  if (!about.words.empty() && std::ranges::find(about.words, word) == about.words.end())
    fail(key, fmt::format("there is no \"{}\"{}", one_line(word),
                          did_you_mean(word, {about.words.begin(), about.words.end()})));
  into = word;
  return true;
}

bool TomlTable::fetch(std::string_view key, std::filesystem::path& into, const About&) const {
  std::string text;
  if (!fetch(key, text, {})) return false;
  into = path_of(*find(key)->as_string());
  return true;
}

bool TomlTable::fetch(std::string_view key, Vec3& into, const About&) const {
  std::vector<double> numbers;
  if (!fetch(key, numbers, {})) return false;
  if (numbers.size() != 3) wrong_type(key, *find(key), "three numbers [x, y, z]");
  into = Vec3(numbers.data());
  return true;
}

bool TomlTable::fetch(std::string_view key, std::vector<double>& into, const About&) const {
  const toml::node* node = find(key);
  if (!node) return false;
  into.clear();
  if (const auto lone = number_of(*node)) return into = {check_range(key, *lone, kAnyNumber)}, true;
  const toml::array* array = node->as_array();
  if (!array) wrong_type(key, *node, "numbers [x, y, z]");
  for (const toml::node& cell : *array) {
    const auto value = number_of(cell);
    if (!value) wrong_type(key, cell, "numbers [x, y, z]");
    into.push_back(check_range(key, *value, kAnyNumber));
  }
  return true;
}

bool TomlTable::fetch(std::string_view key, Course& into, const About& about) const {
  const toml::node* node = find(key);
  if (!node) return false;
  if (const auto lone = number_of(*node)) {
    into = Course({{0, check_range(key, *lone, about.range)}});
    return true;
  }
  if (!node->is_array()) wrong_type(key, *node, "a number, or rows [time in ps, number]");
  const toml::array& rows = *node->as_array();
  std::vector<Course::Point> points;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const toml::array* row = rows[k].as_array();
    const auto cell = [&](std::size_t c) {
      return row && row->size() == 2 ? number_of((*row)[c]) : std::nullopt;
    };
    const auto t = cell(0), value = cell(1);
    if (!t || !value) fail(key, k, "expected a time in ps and a number, as [[0, 300], [100, 400]]");
    if (!std::isfinite(*t) || *t < 0 || (k > 0 && *t <= points.back().t))
      fail(key, k, "expected rising times of 0 or more");
    if (!std::isfinite(*value) || !about.range.holds(*value))
      fail(key, k, fmt::format("expected {}, got {}", about.range.in_words(), *value));
    points.push_back({*t, *value});
  }
  if (points.empty()) fail(key, "expected at least one row [time in ps, number]");
  into = Course(std::move(points));
  return true;
}

bool TomlTable::read(std::string_view key, Rows& into, Columns columns, const About& about) const {
  const toml::node* node = find(key);
  if (!node) {
    record(key, into, about);
    return false;
  }
  if (!node->is_array()) wrong_type(key, *node, "an array of rows");
  const toml::array& rows = *node->as_array();
  into.clear();
  into.reserve(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const toml::array* row = rows[k].as_array();
    if (!row) fail(key, k, fmt::format("expected a row of numbers, got {}", type_name(rows[k])));
    if (row->size() < columns.min || row->size() > columns.max)
      fail(key, k, fmt::format("expected {} numbers, got {}", columns.max, row->size()));
    std::vector<double>& numbers = into.emplace_back();
    for (const toml::node& cell : *row) {
      const auto value = number_of(cell);
      if (!value) fail(key, k, fmt::format("expected numbers, got {}", type_name(cell)));
      if (!std::isfinite(*value)) fail(key, k, "expected finite numbers");
      numbers.push_back(*value);
    }
  }
  record(key, into, about);
  return true;
}

Rows TomlTable::get_rows(std::string_view key, Columns columns, const About& about) const {
  Rows rows;
  if (!read(key, rows, columns, about)) missing(key);
  return rows;
}

std::string TomlTable::choice(std::string_view key, const std::vector<std::string_view>& words,
                              const char* meaning) const {
  const auto word = get<std::string>(key, About(meaning, words));
  return describing() ? std::string(words.front()) : word;
}

void TomlTable::record(std::string_view key, const About& about, const char* type, std::string value) const {
  Key& noted = keys_->of(name_, key);
  noted.about = about;
  noted.type = type;
  noted.value = std::move(value);
  noted.read = true;
  noted.idle = false;
  if (const toml::node* node = find(key)) noted.from = location_of(node);
}

void TomlTable::require_effect(std::string_view key, bool read, std::string_view where,
                               const std::vector<std::string_view>& decided_by) const {
  const auto changed = [&](std::string_view other) { return overridden(other); };
  const bool set_aside = !overridden(key) && std::ranges::any_of(decided_by, changed);
  if (has(key) && !read && !set_aside) fail(key, fmt::format("has no effect, it counts only {}", where));
  if (!keys_) return;
  Key& noted = keys_->of(name_, key);
  noted.idle |= !read;
  if (noted.counts_only.find(where) == std::string::npos)
    noted.counts_only += (noted.counts_only.empty() ? "" : "; ") + std::string(where);
}

bool TomlTable::overridden(std::string_view key) const {
  const toml::node* node = find(key);
  return node && is_of_override(*node);
}

void TomlTable::fail(std::string_view key, const std::string& message) const {
  throw LocatedError(fmt::format("{}: {}: {}", location_of(find(key)), full_name(key), message));
}

void TomlTable::fail(std::string_view key, std::size_t row, const std::string& message) const {
  const toml::node* node = find(key);
  const toml::array* rows = node ? node->as_array() : nullptr;
  const toml::node* one = rows && row < rows->size() ? &(*rows)[row] : nullptr;
  const std::string which = one && one->is_table() ? fmt::format(".{}", row) : fmt::format("[{}]", row);
  throw LocatedError(
      fmt::format("{}: {}{}: {}", location_of(one ? one : node), full_name(key), which, message));
}

void TomlTable::refuse(std::initializer_list<std::string_view> keys, const char* message) const {
  for (const std::string_view key : keys)
    if (table_.contains(key)) fail(key, message);
}

void TomlTable::reject_unknown() const {
  const std::vector<std::string_view> known(asked_.begin(), asked_.end());
  for (const auto& entry : table_) {
    const std::string_view key = entry.first.str();
    const toml::node& node = entry.second;
    if (asked_.contains(key)) continue;
    throw LocatedError(fmt::format(
        "{}: unknown {} \"{}\"{}{}", location_of(&node), node.is_table() ? "section" : "key", one_line(key),
        name_.empty() ? "" : fmt::format(" in [{}]", name_), did_you_mean(key, known)));
  }
}

const toml::node* TomlTable::find(std::string_view key) const {
  asked_.emplace(key);
  return table_.get(key);
}

// A float without a fraction, 1e6, is accepted as an integer.
std::optional<std::int64_t> TomlTable::integer(std::string_view key, Range range) const {
  const toml::node* node = find(key);
  if (!node) return {};
  const auto value = number_of(*node);
  if (!value || *value != std::floor(*value)) wrong_type(key, *node, "an integer");
  check_range(key, *value, range);
  if (std::abs(*value) >= 0x1p63) fail(key, "out of range");
  return node->is_integer() ? node->as_integer()->get() : static_cast<std::int64_t>(*value);
}

std::string TomlTable::full_name(std::string_view key) const {
  return name_.empty() ? std::string(key) : fmt::format("{}.{}", name_, key);
}

std::string TomlTable::location_of(const toml::node* node) const {
  if (!node || !node->source().path) return where_;
  const auto& [path, line] = std::tie(*node->source().path, node->source().begin.line);
  if (path.starts_with(kOverride) || line == 0) return path;
  return fmt::format("{}:{}", path, line);
}

void TomlTable::missing(std::string_view key) const {
  if (describing()) {
    keys_->of(name_, key).required = true;
    return;
  }
  std::vector<std::string_view> unread;  // candidates for a misspelt key
  for (const auto& entry : table_)
    if (!asked_.contains(entry.first.str())) unread.push_back(entry.first.str());
  const std::string_view near = nearest_name(key, unread);
  throw LocatedError(fmt::format("{}: missing key \"{}\"{}{}", where_, key,
                                 name_.empty() ? "" : fmt::format(" in [{}]", name_),
                                 near.empty() ? "" : fmt::format("; is \"{}\" meant for it?", near)));
}

void TomlTable::wrong_type(std::string_view key, const toml::node& got, const char* expected) const {
  throw LocatedError(fmt::format("{}: {}: expected {}, got {}", location_of(&got), full_name(key), expected,
                                 type_name(got)));
}

double TomlTable::check_range(std::string_view key, double value, Range range) const {
  if (!std::isfinite(value)) fail(key, fmt::format("expected a finite number, got {}", value));
  if (!range.holds(value)) fail(key, fmt::format("expected {}, got {}", range.in_words(), value));
  return value;
}

std::filesystem::path path_of(const toml::value<std::string>& name) {
  const auto& source = name.source().path;
  const bool in_file = source && !is_of_override(name);
  return (in_file ? std::filesystem::path(*source).parent_path() : std::filesystem::path()) / name.get();
}

toml::table parse_toml_file(const std::filesystem::path& file) {
  std::error_code unreadable;
  if (!std::filesystem::exists(file, unreadable)) throw LocatedError(file.string() + ": no such file");
  if (!std::filesystem::is_regular_file(file, unreadable)) throw LocatedError(file.string() + ": not a file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw LocatedError(file.string() + ": cannot be read");
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  return parse_toml_text(text, file);
}

toml::table parse_toml_text(std::string_view text, const std::filesystem::path& file) {
  HeardText pieces(text);
  try {
    std::istream stream(&pieces);
    toml::table table = toml::parse(stream, file.string());
    pieces.rethrow();
    return table;
  } catch (const toml::parse_error& e) {
    pieces.rethrow();
    throw LocatedError(fmt::format("{}:{}: not valid TOML: {}", file.string(), e.source().begin.line,
                                   one_line(e.description())));
  }
}

}  // namespace taut
