#pragma once

#include <filesystem>

#include "files/disk_file.hpp"

namespace taut {

// Lets one process at a time write to a folder, by a lock (flock(2)) on FOLDER/.lock. The kernel releases the
// lock however the process ends; the empty file stays. On a file system without locks every process is
// admitted.
class FolderLock {
 public:
  // Makes the folder. Throws InputError if another process has the lock, OutsideError if the disk refuses.
  explicit FolderLock(std::filesystem::path folder);

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  DiskFile file_;
};

}  // namespace taut
