#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

namespace taut {

// "1 step", "2 steps".
inline std::string counted(long n, const char* one) {
  return fmt::format("{} {}{}", n, one, n == 1 ? "" : "s");
}

int columns_of(const std::string& text);  // on a terminal, of UTF-8 without wide letters
int terminal_width();                     // COLUMNS, or stdout's up to 120; no end where that is no terminal

// In lines of at most so many columns; all but the first indented.
std::string wrapped(const std::string& text, int width, int indent);

// Cells side by side, as wide as they need to be, but for the last, which is wrapped.
std::string table_text(const std::vector<std::vector<std::string>>& rows, int width);

}  // namespace taut
