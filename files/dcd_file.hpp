#pragma once

#include "files/frame.hpp"
#include "files/output.hpp"

namespace taut {

// Writes positions in CHARMM's binary format, which NAMD, OpenMM, VMD and MDAnalysis read: Å, single
// precision, the edges and angles of the box before each frame, the step in AKMA units of time. The header's
// counts are updated with each frame. They have 32 bits: before a step number would exceed them, the header's
// unit of time becomes the time between frames, so that readers still find the right times. The mark of this
// output is in bytes.
class DcdFile : public Output {
 public:
  // mark 0 makes a new file; otherwise the existing file is truncated to the mark.
  DcdFile(const std::filesystem::path& path, const TrajectorySetup& setup, std::uint64_t mark);

  void add(const Frame& frame);
  std::uint64_t mark() override { return file_.mark(); }

 private:
  std::uint64_t frame_bytes() const;
  void count_frames(std::uint64_t frames);

  GrowingFile file_;
  bool periodic_;
  long atoms_;
  // Fields of the header: step of the first frame, steps between frames, length of a step [AKMA units].
  std::int64_t first_, every_;
  float step_;
};

}  // namespace taut
