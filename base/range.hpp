#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace taut {

// The numbers a setting may have.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool above_min = false, below_max = false;  // the ends themselves are out

  friend bool operator==(const Range&, const Range&) = default;
  bool holds(double value) const {
    return (above_min ? value > min : value >= min) && (below_max ? value < max : value <= max);
  }
  bool any() const { return *this == Range{}; }
  std::string in_words() const;  // "more than 0 and at most 2"
};
inline constexpr Range kAnyNumber{};
inline constexpr Range kNotNegative{.min = 0};
inline constexpr Range kPositive{.min = 0, .above_min = true};

// Says what a setting may be: one of the words, or a number of the range; "" where anything is allowed.
std::string allowed(const Range& range, const std::vector<std::string_view>& words);

}  // namespace taut
