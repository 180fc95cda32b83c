#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

#include "files/disk_file.hpp"

namespace taut {

// A file to which a run appends (its log, its trajectories). A checkpoint stores the mark of every output. A
// run that resumes from the checkpoint reopens the output with its mark, and what was written after it is cut
// off. A mark of 0 means a new file.
class Output {
 public:
  virtual ~Output() = default;

  // Makes the data written so far survive a crash of the machine, and returns its amount, in bytes or frames
  // depending on the format; never 0 once there is data. Throws OutsideError for a full disk, a deleted file,
  // ...
  virtual std::uint64_t mark() = 0;
};

std::uint64_t size_of(const std::filesystem::path& file);  // [bytes]; 0 if it does not exist

// An output of bytes. It never holds a part of what was given to write(): if the disk refuses a part, all of
// it is removed.
class GrowingFile : public Output {
 public:
  // mark 0 makes an empty file. Otherwise the existing file is truncated to so many bytes; throws
  // OutsideError if it does not exist or is shorter.
  GrowingFile(const std::filesystem::path& path, std::uint64_t mark);

  void write(std::string_view bytes);                      // appends; other processes see it at once
  void rewrite(std::uint64_t at, std::string_view bytes);  // overwrites, e.g. a count of frames in a header
  std::uint64_t size() const { return size_; }
  std::uint64_t mark() override;

 private:
  DiskFile file_;
  std::uint64_t size_;
};

}  // namespace taut
