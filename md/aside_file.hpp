#pragma once

#include <filesystem>
#include <fstream>
#include <string_view>

namespace taut {

// A file written aside and renamed when whole: nobody ever sees half of it. Dropped if not committed.
// Throws OutsideError, naming the file, where the disk or the folder refuses.
class AsideFile {
 public:
  explicit AsideFile(std::filesystem::path path);
  AsideFile(const AsideFile&) = delete;
  AsideFile& operator=(const AsideFile&) = delete;
  ~AsideFile();

  void write(std::string_view text);  // and flushes
  void commit();

 private:
  std::filesystem::path path_, aside_;
  std::ofstream out_;
  bool committed_ = false;
};

// Makes a folder, with those above it.
void make_folder(const std::filesystem::path& folder);

}  // namespace taut
