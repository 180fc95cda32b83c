#pragma once

#include <filesystem>
#include <fstream>

#include "base/vectors.hpp"
#include "md/box.hpp"

namespace taut {

// Reads what DcdFile wrote, frame by frame. Throws InputError for another kind of file.
class DcdReader {
 public:
  explicit DcdReader(const std::filesystem::path& path);

  int atoms() const { return atoms_; }
  double interval() const { return interval_; }  // from frame to frame [ps]

  // The next frame: positions [nm], and the box if there is one. False behind the last one that is whole.
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
