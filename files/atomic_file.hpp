#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "files/disk_file.hpp"

namespace taut {

// A file that appears under its name only when it is complete: it is written to "<file>.part" and renamed by
// commit(), so that no reader sees a part of it, even after a crash of the machine. Without a commit() it is
// deleted. Throws OutsideError, which names the file, where the disk or the folder refuses.
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
  std::optional<DiskFile> file_;  // empty after commit()
  std::uint64_t size_ = 0;
};

// Writes a file whole.
void write_file(const std::filesystem::path& path, std::string_view text);

}  // namespace taut
