#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

namespace taut {

// The name fewest edits away from what was typed, for "did you mean". Empty without names.
inline std::string_view nearest_name(std::string_view typed, const std::vector<std::string_view>& names) {
  const auto edits = [typed](std::string_view name) {  // Levenshtein's distance, a row at a time
    std::vector<std::size_t> row(name.size() + 1);
    for (std::size_t j = 0; j <= name.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= typed.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i;
      for (std::size_t j = 1; j <= name.size(); ++j) {
        const std::size_t replaced = diagonal + (typed[i - 1] != name[j - 1]);
        diagonal = row[j];
        row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
      }
    }
    return row.back();
  };
  const auto best =
      std::min_element(names.begin(), names.end(), [&](auto a, auto b) { return edits(a) < edits(b); });
  return best == names.end() ? std::string_view{} : *best;
}

}  // namespace taut
