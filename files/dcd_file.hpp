#pragma once

#include "files/frame.hpp"
#include "files/output.hpp"

namespace taut {

// Positions in CHARMM's binary format, as NAMD, OpenMM, VMD and MDAnalysis read it: in Å, single precision,
// the box's edges and angles before each frame, the step in AKMA units of time. The header's counts are kept
// up to date. They have 32 bits: before a number of steps outgrows these, the header's unit of time becomes
// the time from frame to frame, so that readers go on to find the times of frames. An output's mark is in
// bytes.
class DcdFile : public Output {
 public:
  // mark 0: a new file; else the one there is, cut back to it.
  DcdFile(const std::filesystem::path& path, const TrajectorySetup& setup, std::uint64_t mark);

  void add(const Frame& frame);
  std::uint64_t mark() override { return file_.mark(); }

 private:
  std::uint64_t frame_bytes() const;
  void count_frames(std::uint64_t frames);

  GrowingFile file_;
  bool periodic_;
  long atoms_;
  // As the header has them: the first frame's step, steps from frame to frame, and a step's length in AKMA
  // units.
  std::int64_t first_, every_;
  float step_;
};

}  // namespace taut
