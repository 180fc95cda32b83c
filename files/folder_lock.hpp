#pragma once

#include <filesystem>

#include "files/disk_file.hpp"

namespace taut {

// A folder that one process writes to at a time: the lock of FOLDER/.lock (flock(2)), which the kernel takes
// back however the process ends; the empty file stays. Where the file system knows no locks, all are let in.
class FolderLock {
 public:
  // Makes the folder. Throws InputError where another process has it, OutsideError where the disk refuses.
  explicit FolderLock(std::filesystem::path folder);

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  DiskFile file_;
};

}  // namespace taut
