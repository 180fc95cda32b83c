#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "commands.hpp"
#include "measures/picture.hpp"

namespace taut {

// Said with --size and --format.
struct PictureOptions {
  int size = 170;  // width [mm]
  std::vector<std::string> formats = {"png"};

  void offer(const Subcommand& command);
};

// The files that a study writes into its folder.
class StudyFiles {
 public:
  StudyFiles(std::filesystem::path folder, PictureOptions options)
      : folder_(std::move(folder)), options_(std::move(options)) {}

  const std::filesystem::path& folder() const { return folder_; }
  void write(const std::string& name, const std::string& text);
  void draw(const Picture& picture);  // writes its table; draw_all() draws it

  // Draws all pictures that are not drawn yet, in one start of Python; those named for a page as SVG, too.
  void draw_all(const std::vector<std::string>& for_page = {});
  // Returns a picture that was drawn for a page, or an empty text.
  std::string svg(const std::string& name) const;

  // Prints one line with the files written, and one with the pictures not drawn. Throws OutsideError if drawing
  // failed. If Python has no matplotlib, the tables are still there, and no error is thrown.
  void print_written();

 private:
  void take(const std::string& drawn);  // what was drawn, as JSON

  std::filesystem::path folder_;
  PictureOptions options_;
  std::vector<Picture> asked_;
  std::map<std::string, std::string> svg_;
  std::vector<std::string> written_, empty_, undrawn_;  // undrawn_: pictures that failed
  std::string missing_, reason_,
      refused_;  // what Python has not; why the first of them failed; what it was asked in vain
};

// The files that a picture may leave in a folder.
std::vector<std::string> files_of_picture(const std::string& name);

}  // namespace taut
