#include "base/nearest_name.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "base/errors.hpp"

namespace taut {
namespace {

// Letters put in, left out, replaced, or two neighbours swapped (Damerau 1964, doi:10.1145/363958.363994), no
// letter touched twice. e(i, j) of the first i letters of a and the first j of b, a row of j at a time.
std::size_t edits(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last, last, now(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) now[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_last = std::exchange(last, now);
    now[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        now[j] = std::min(now[j], before_last[j - 2] + 1);
    }
  }
  return now.back();
}

bool near(std::string_view a, std::string_view b) {
  return edits(a, b) <= std::max<std::size_t>(1, std::max(a.size(), b.size()) / 3);
}

}  // namespace

std::string_view nearest_name(std::string_view typed, const std::vector<std::string_view>& names) {
  const auto longer =
      std::ranges::find_if(names, [&](auto name) { return typed.size() > 1 && name.starts_with(typed); });
  if (longer != names.end()) return *longer;
  const auto best = std::ranges::min_element(names, {}, [&](auto name) { return edits(typed, name); });
  return best != names.end() && near(typed, *best) ? *best : std::string_view{};
}

std::string did_you_mean(std::string_view typed, const std::vector<std::string_view>& names) {
  if (const auto nearest = nearest_name(typed, names); !nearest.empty())
    return fmt::format("; did you mean \"{}\"?", nearest);
  return names.empty() ? "" : fmt::format("; expected one of {}", fmt::join(names, ", "));
}

void expect_name(std::string_view key, std::string_view name, const std::vector<std::string_view>& names) {
  if (std::ranges::find(names, name) == names.end())
    throw InputError(fmt::format("{}: there is no \"{}\"{}", key, name, did_you_mean(name, names)));
}

}  // namespace taut
