#pragma once

#include <fmt/format.h>

#include <limits>
#include <string>

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
  std::string in_words() const {
    std::string least = fmt::format("{} {}", above_min ? "more than" : "at least", min);
    std::string most = fmt::format("{} {}", below_max ? "less than" : "at most", max);
    if (max == std::numeric_limits<double>::infinity()) return least;
    return min == -std::numeric_limits<double>::infinity() ? most : least + " and " + most;
  }
};
inline constexpr Range kAnyNumber{};
inline constexpr Range kNotNegative{.min = 0};
inline constexpr Range kPositive{.min = 0, .above_min = true};

}  // namespace taut
