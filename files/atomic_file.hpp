#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "files/disk_file.hpp"

namespace taut {

// A file written aside and renamed when whole: nobody ever sees half of it, not even after a crash of the
// machine. Dropped if not committed. Throws OutsideError, naming the file, where the disk or the folder
// refuses.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  void write(std::string_view text);
  void commit();

 private:
  std::filesystem::path path_, aside_;
  std::optional<DiskFile> file_;  // until committed
  std::uint64_t size_ = 0;
};

// Makes a folder, with those above it.
void make_folder(const std::filesystem::path& folder);

}  // namespace taut
