#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace taut {

// A cell of a CSV table, in quotes where it has to be. Line breaks become spaces, so that a row stays a line,
// and double quotes single ones: doubled, as RFC 4180 has them, they crash gnuplot 5.4.
std::string csv_cell(std::string_view text);

// The same of a name that a picture shows and tells curves apart by, with semicolons for commas: gnuplot 5.4 ends
// quoted text at a comma.
std::string label_cell(std::string text);

// The cells of every line of a table, its header first.
std::vector<std::vector<std::string>> csv_rows(std::string_view csv);

}  // namespace taut
