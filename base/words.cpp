#include "base/words.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>

namespace taut {

int width_of(const std::string& text) {
  return static_cast<int>(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::optional<double> number_in(std::string_view text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

std::string wrapped(const std::string& text, int width, int indent) {
  std::istringstream words(text);
  std::string lines, word;
  int column = indent;
  while (words >> word) {
    const int wide = width_of(word);
    if (column > indent && column + 1 + wide > width) {
      lines.append(1, '\n').append(static_cast<std::size_t>(indent), ' ');
      column = indent;
    } else if (column > indent) {
      lines += " ";
      ++column;
    }
    lines += word;
    column += wide;
  }
  return lines;
}

std::string table_text(const std::vector<std::vector<std::string>>& rows, int width) {
  std::vector<int> wide;
  for (const auto& row : rows) {
    wide.resize(std::max(wide.size(), row.size()));
    for (std::size_t k = 0; k < row.size(); ++k) wide[k] = std::max(wide[k], width_of(row[k]));
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    int column = 0;
    for (std::size_t k = 0; k + 1 < row.size(); ++k) {
      line += row[k] + std::string(static_cast<std::size_t>(wide[k] - width_of(row[k]) + 2), ' ');
      column += wide[k] + 2;
    }
    if (!row.empty()) line += wrapped(row.back(), std::max(width, column + 30), column);
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

}  // namespace taut
