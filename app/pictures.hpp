#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace taut {

// A picture as four files that stay together: NAME.csv, the gnuplot script NAME.gp that reads it, and the
// NAME.svg and NAME.png it makes (`gnuplot NAME.gp` in the folder draws them again).
struct Picture {
  std::string name;
  std::string csv;
  std::string script;  // what to set and plot; its data is called csv. Empty: nothing got through to be drawn
  int width = 800, height = 520;
};

// Text as a string of a gnuplot script, whatever is in it: nothing of it is read as a command.
std::string gnuplot_string(std::string_view text);

// The same as the label of a tic, where a % would begin a number's format.
std::string gnuplot_tic(std::string_view text);

// A method's colour and mark, the same in every picture and told apart without colour: "lc rgb '...' pt 7".
std::string mark_of(const std::string& method);

// What a study writes into its folder, by name, and what of it is there.
class StudyFiles {
 public:
  explicit StudyFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  const std::filesystem::path& folder() const { return folder_; }
  void write(const std::string& name, const std::string& text);
  void draw(const Picture& picture);

  // A line of all that is there, and one of what is not drawn. Throws OutsideError where gnuplot failed;
  // where it is not installed all is well, the figures and scripts being there.
  void tell() const;

 private:
  std::filesystem::path folder_;
  std::vector<std::string> written_, empty_, undrawn_;  // undrawn: gnuplot failed
  bool without_gnuplot_ = false;
};

}  // namespace taut
