#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "files/disk_file.hpp"

namespace taut {

// Makes a folder and its missing parents. Throws OutsideError.
void make_folder(const std::filesystem::path& folder);

// A folder that one process at a time writes to. The lock is FOLDER/.lock (flock(2)), which the kernel
// releases however the process ends; the empty file stays. A file system without locks lets everybody in.
class FolderLock {
 public:
  // Makes the folder. Throws InputError where another process holds it, OutsideError where the disk refuses.
  explicit FolderLock(std::filesystem::path folder);

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  DiskFile file_;
};

// Returns which of the named files are in the folder.
std::vector<std::string> list_present(const std::filesystem::path& folder,
                                      const std::vector<std::string>& names);

// Returns the folder's path to which move_to_backup() appends a number: without a slash at the end, and with
// links followed.
std::filesystem::path backup_base(const std::filesystem::path& folder);

// Moves the named files from FOLDER to a new folder beside it: FOLDER.1, or the first number that is free.
// Returns the new folder. All other files stay. Throws OutsideError.
std::filesystem::path move_to_backup(const std::filesystem::path& folder,
                                     const std::vector<std::string>& names);

}  // namespace taut
