#pragma once

#include "files/frame.hpp"
#include "files/output.hpp"

namespace taut {

// Positions in CHARMM's binary format, as NAMD, OpenMM, VMD and MDAnalysis read it: in Å, single precision,
// the box's edges and angles before each frame, the step in AKMA units of time. The header's count of frames
// is kept up to date. An output's mark is in bytes.
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
  long atoms_, every_;
};

}  // namespace taut
