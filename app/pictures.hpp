#pragma once

#include <filesystem>
#include <string>

namespace taut {

// A picture as four files that stay together: NAME.csv, the gnuplot script NAME.gp that reads it, and the
// NAME.svg and NAME.png it makes (`gnuplot NAME.gp` in the folder draws them again).
struct Picture {
  std::string name;
  std::string csv;
  std::string script;  // what to set and plot; its data is called csv
  int width = 800, height = 520;
};

// Writes all four; without gnuplot, the first two and a line that says so. True if it was drawn.
bool draw(const Picture& picture, const std::filesystem::path& folder);

// A method's colour and mark, the same in every picture and told apart without colour: "lc rgb '...' pt 7".
std::string mark_of(const std::string& method);

void write_text(const std::filesystem::path& file, const std::string& text);

}  // namespace taut
