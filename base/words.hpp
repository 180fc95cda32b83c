#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace taut {

// Returns "1 step", "2 steps".
inline std::string counted(long n, const char* one) {
  return fmt::format("{} {}{}", n, one, n == 1 ? "" : "s");
}

int width_of(const std::string& text);  // width on a terminal, for UTF-8 without wide characters

// Wraps text to lines of at most so many columns, indented from the second line on.
std::string wrapped(const std::string& text, int width, int indent);

// The number that the whole of a text is; none where it is anything else.
std::optional<double> number_in(std::string_view text);

// Aligns cells in columns as wide as needed; the last column is wrapped.
std::string table_text(const std::vector<std::vector<std::string>>& rows, int width);

}  // namespace taut
