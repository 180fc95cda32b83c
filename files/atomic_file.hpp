#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "files/disk_file.hpp"

namespace taut {

// A file that is written under another name and renamed on commit(), so that no reader sees a part of it,
// even after a crash of the machine. Without commit() it is deleted. Throws OutsideError, which names the
// file, if the disk or the folder refuses.
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

// Makes a folder and its parents.
void make_folder(const std::filesystem::path& folder);

}  // namespace taut
