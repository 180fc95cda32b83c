#pragma once

#include <filesystem>
#include <fstream>

#include "base/vectors.hpp"
#include "files/frame.hpp"
#include "files/output.hpp"
#include "md/box.hpp"

namespace taut {

inline constexpr double kAkma = 0.04888821;  // CHARMM's unit of time, √(u·Å²/(kcal/mol)) [ps]

// Writes positions in CHARMM's binary format (DCD), which NAMD, OpenMM, VMD and MDAnalysis read. Positions
// are in Å and single precision, the unit cell precedes each frame, and the time step is in AKMA units. The
// header counts frames and steps in 32 bits and is updated with every frame. Before a count of steps
// overflows, the header's time step becomes the time between frames, so that readers still find each frame's
// time. Marks are in bytes.
class DcdFile : public Output {
 public:
  // mark 0 starts a new file; any other mark opens the existing file and truncates it to that size.
  DcdFile(const std::filesystem::path& path, const TrajectorySetup& setup, std::uint64_t mark);

  void add(const Frame& frame);
  std::uint64_t mark() override { return file_.mark(); }

 private:
  std::uint64_t frame_bytes() const;
  void write_counts(std::uint64_t frames);

  GrowingFile file_;
  bool periodic_;
  long atoms_;
  std::int64_t first_;  // step of the first frame, as the header counts steps
  std::int64_t every_;  // steps between frames
  float step_;          // time step [AKMA]
};

// Reads a file written by DcdFile, frame by frame. Throws InputError for any other kind of file.
class DcdReader {
 public:
  explicit DcdReader(const std::filesystem::path& path);

  int atoms() const { return atoms_; }
  double time_of(long frame) const { return first_ + static_cast<double>(frame) * interval_; }  // [ps]
  long frames() const;  // complete ones, as the file stands now

  // Goes past the next frame without reading it.
  void skip();
  // Reads the next frame: positions [nm], and the box where the file has one. Returns false after the last
  // complete frame.
  bool next(Vectors& x, Box& box);

 private:
  bool read_record(std::size_t length, void* into);
  std::streamoff frame_bytes() const;

  std::filesystem::path path_;
  std::ifstream in_;
  std::streamoff frames_begin_ = 0;  // where the first frame stands [bytes]
  bool periodic_ = false;
  int atoms_ = 0;
  double interval_ = 0, first_ = 0;
};

}  // namespace taut
