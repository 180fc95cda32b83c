#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

#include "files/disk_file.hpp"

namespace taut {

// A file that a run adds to while it goes on (its log, its trajectories), and that a checkpoint can be gone
// back to. A checkpoint keeps every output's mark; a run that goes on from it reopens the output with that
// mark, and what was written after it is cut off. Where nothing is known the mark is 0: set out anew.
class Output {
 public:
  virtual ~Output() = default;

  // Makes what was written so far outlast a crash of the machine, and says how far that is: bytes, or frames
  // where the format counts in frames; never 0 once something is there.
  // Throws OutsideError for a full disk, a file that vanished, ...
  virtual std::uint64_t mark() = 0;
};

std::uint64_t size_of(const std::filesystem::path& file);  // bytes; 0 where it is not there

// The plain kind: bytes at the end of a file. Never holds half of what was given to write(): where the disk
// refuses a part of it, all of it is taken back.
class GrowingFile : public Output {
 public:
  // mark 0: an empty file, whatever was there. Else the file there is, cut back to so many bytes; throws
  // OutsideError where it is not there or shorter than that.
  GrowingFile(const std::filesystem::path& path, std::uint64_t mark);

  void write(std::string_view bytes);                      // at the end, seen by others at once
  void rewrite(std::uint64_t at, std::string_view bytes);  // over what is there: a header's count of frames
  std::uint64_t size() const { return size_; }
  std::uint64_t mark() override;

 private:
  DiskFile file_;
  std::uint64_t size_;
};

}  // namespace taut
