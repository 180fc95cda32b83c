#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "base/vectors.hpp"
#include "md/box.hpp"

namespace taut {

// Reads the positions of a file written by H5mdFile, frame by frame; of a run that goes on or was killed, the
// frames of the last commit. Throws InputError for any other file.
class H5mdReader {
 public:
  explicit H5mdReader(const std::filesystem::path& path);
  ~H5mdReader();

  int atoms() const { return atoms_; }
  long frames() const;
  double time_of(long frame) const { return times_.at(static_cast<std::size_t>(frame)); }  // [ps]

  // Goes past the next frame without reading it.
  void skip();
  // Reads the next frame: positions [nm], and the box where the file has one. Returns false after the last.
  bool next(Vectors& x, Box& box);
  // The tension of each rigid bond in the frame that next() or skip() passed last [kJ/mol/nm]; empty where the file has none.
  Eigen::VectorXd tensions() const;

 private:
  struct Contents;
  std::unique_ptr<Contents> contents_;
  int atoms_ = 0;
  std::vector<double> times_;
};

}  // namespace taut
