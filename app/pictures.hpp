#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace taut {

// A picture consists of NAME.csv, the gnuplot script NAME.gp that reads it, and NAME.svg and NAME.png. The
// scripts share taut.gp and the titles in titles.tsv in the same folder, so that `gnuplot NAME.gp` there
// draws the picture again.
struct Picture {
  std::string name;
  std::string title;
  std::string csv;
};

// The files that a study writes into its folder.
class StudyFiles {
 public:
  explicit StudyFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  const std::filesystem::path& folder() const { return folder_; }
  void write(const std::string& name, const std::string& text);
  void draw(const Picture& picture);

  // Prints one line with the files written, and one with the pictures not drawn. Throws OutsideError if
  // gnuplot failed. If gnuplot is not installed, data and scripts are still there, and no error is thrown.
  void print_written() const;

 private:
  std::filesystem::path folder_;
  std::string titles_ = "picture\ttitle\n";
  std::vector<std::string> written_, empty_, undrawn_;  // undrawn_: pictures on which gnuplot failed
  bool without_gnuplot_ = false;
};

// Returns the contents of a file, or nothing if it does not exist.
std::string contents_of(const std::filesystem::path& file);

}  // namespace taut
