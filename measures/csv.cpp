#include "measures/csv.hpp"

#include <algorithm>

namespace taut {

std::string csv_cell(std::string_view text) {
  std::string cell(text);
  std::ranges::replace(cell, '"', '\'');
  std::ranges::replace_if(
      cell, [](unsigned char c) { return c < ' '; }, ' ');
  return cell.find_first_of(",#'") == cell.npos ? cell : '"' + cell + '"';
}

std::vector<std::vector<std::string>> csv_rows(std::string_view csv) {
  std::vector<std::vector<std::string>> rows;
  bool line_begins = true, inside = false;
  for (const char c : csv) {
    if (line_begins) rows.emplace_back(1);
    line_begins = c == '\n';
    if (c == '"')
      inside = !inside;
    else if (c == ',' && !inside)
      rows.back().emplace_back();
    else if (!line_begins)
      rows.back().back() += c;
  }
  return rows;
}

}  // namespace taut
