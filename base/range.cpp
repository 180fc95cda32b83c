#include "base/range.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace taut {

std::string Range::in_words() const {
  std::string least = fmt::format("{} {}", above_min ? "more than" : "at least", min);
  std::string most = fmt::format("{} {}", below_max ? "less than" : "at most", max);
  if (max == std::numeric_limits<double>::infinity()) return least;
  return min == -std::numeric_limits<double>::infinity() ? most : least + " and " + most;
}

std::string allowed(const Range& range, const std::vector<std::string_view>& words) {
  if (!words.empty()) return fmt::format("one of {}", fmt::join(words, ", "));
  return range.any() ? "" : range.in_words();
}

}  // namespace taut
