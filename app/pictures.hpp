#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace taut {

// A picture as files that stay together: NAME.csv, the gnuplot script NAME.gp that reads it, and the NAME.svg
// and NAME.png it makes. Beside them is what the scripts share: taut.gp, and the titles in titles.tsv. So
// `gnuplot NAME.gp` in the folder draws them again, on another machine too.
struct Picture {
  std::string name;
  std::string title;
  std::string csv;
};

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
  std::string titles_ = "picture\ttitle\n";
  std::vector<std::string> written_, empty_, undrawn_;  // undrawn: gnuplot failed
  bool without_gnuplot_ = false;
};

// What a file holds; nothing where there is none.
std::string contents_of(const std::filesystem::path& file);

}  // namespace taut
