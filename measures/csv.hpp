#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace taut {

// A cell of a CSV table, in quotes where it has to be. Line breaks become spaces, so that a row stays a line,
// and double quotes single ones, which every reader of such tables takes.
std::string csv_cell(std::string_view text);

// The cells of every line of a table, its header first.
std::vector<std::vector<std::string>> csv_rows(std::string_view csv);

}  // namespace taut
