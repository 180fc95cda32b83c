#pragma once

#include <filesystem>
#include <fstream>

#include "base/vectors.hpp"
#include "md/box.hpp"

namespace taut {

// Reads a file that DcdFile wrote, frame by frame. Throws InputError for other files.
class DcdReader {
 public:
  explicit DcdReader(const std::filesystem::path& path);

  int atoms() const { return atoms_; }
  double interval() const { return interval_; }  // time between frames [ps]

  // Reads the next frame: positions [nm], and the box if there is one. Returns false after the last complete
  // frame.
  bool next(Vectors& x, Box& box);

 private:
  bool record(std::size_t length, void* into);

  std::filesystem::path path_;
  std::ifstream in_;
  bool periodic_ = false;
  int atoms_ = 0;
  double interval_ = 0;
};

}  // namespace taut
