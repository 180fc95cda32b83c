#include "systems/builders/lammps_rows.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

#include "base/nearest_name.hpp"

namespace taut {

LammpsStyle LammpsRows::style_of(const char* section, const std::vector<LammpsStyle>& known) const {
  const std::string_view styled = std::string_view(section) == "PairIJ Coeffs" ? "Pair Coeffs" : section;
  const char* key = nullptr;
  for (const auto& [name, of] : kLammpsStyles)
    if (of == styled) key = name;
  std::string style = said.style.at(std::string(styled));
  if (style.empty()) style = data.section(section).style;
  std::vector<std::string_view> names;
  for (const LammpsStyle& one : known) names.emplace_back(one.name);
  if (style.empty())
    keys.fail("data", fmt::format("the file does not say the style of {}: give build.{}, one of {}", section,
                                  key, fmt::join(names, ", ")));
  const auto found = std::ranges::find(known, style, &LammpsStyle::name);
  if (found == known.end())
    keys.fail(keys.has(key) ? key : "data",
              fmt::format("taut has no {} \"{}\"{}", key, style, did_you_mean(style, names)));
  return *found;
}

const std::vector<LammpsRows::Entry>& LammpsRows::rows(const char* section, std::size_t fixed,
                                                       const std::string& numbers) const {
  const std::vector<Entry>& all = data.section(section).entries;
  std::size_t least = fixed, most = fixed;
  std::istringstream in(numbers);
  for (std::string word; in >> word; ++most)
    if (!word.starts_with('[')) ++least;
  for (const Entry& entry : all)
    if (const std::size_t words = entry.words.size(); words < least || words > most)
      data.fail(entry.line, fmt::format("a row of {} has {} columns, expected {}{}{}", section, words, least,
                                        most > least ? fmt::format(" to {}", most) : "",
                                        numbers.empty() ? "" : ", the last of them " + numbers));
  return all;
}

std::vector<const LammpsRows::Entry*> LammpsRows::numbered(const char* section, const char* of, long count,
                                                           const std::string& numbers) const {
  std::vector<const Entry*> all(static_cast<std::size_t>(count));
  for (const Entry& entry : numbers.empty() ? data.section(section).entries : rows(section, 1, numbers)) {
    const Entry*& at = all[static_cast<std::size_t>(data.index(entry, 0, of, count) - 1)];
    if (at)
      data.fail(entry.line, fmt::format("a second row of {} for {} {}, the first is in line {}", section, of,
                                        entry.words[0], at->line));
    at = &entry;
  }
  return all;
}

std::vector<LammpsRows::Typed> LammpsRows::typed(const List& list, const LammpsStyle& style) const {
  const long count = data.count(list.types);
  const auto of_type = numbered(list.coefficients, "a type", count, style.numbers);
  std::vector<Typed> all;
  for (const Entry& entry : rows(list.name, 2 + list.atoms, "")) {
    const int type = data.index(entry, 1, "a type", count) - 1;
    const Entry* coefficients = of_type[static_cast<std::size_t>(type)];
    if (!coefficients)
      data.fail(entry.line, fmt::format("there is no row of {} for type {}", list.coefficients, type + 1));
    all.push_back({&entry, type, coefficients});
  }
  return all;
}

}  // namespace taut
