#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace taut {

// An unbuffered file of the operating system. Every error is an OutsideError that names the file.
class DiskFile {
 public:
  // Truncate or make the file; open an existing one; open or make it; open an existing one for reading.
  enum Opening { kNew, kThere, kEither, kRead };

  // `named`: its name in error messages, if that is not its path.
  DiskFile(const std::filesystem::path& path, Opening opening, std::filesystem::path named = {});
  DiskFile(DiskFile&& other) noexcept;
  DiskFile& operator=(DiskFile&&) = delete;
  ~DiskFile();

  std::uint64_t size() const;
  std::size_t read(std::uint64_t at, char* into, std::size_t bytes) const;  // returns the bytes read
  void write(std::uint64_t at, std::string_view bytes);
  void cut(std::uint64_t size);
  void cut_quietly(std::uint64_t size) noexcept;
  void sync();               // returns when the data would survive a crash of the machine
  bool still_there() const;  // false if it was deleted
  bool lock();               // locks it until it is closed; false if another process has the lock

  [[noreturn]] void refuse(const char* deed, const char* why) const;

 private:
  [[noreturn]] void refuse(const char* deed) const;  // the reason is in errno

  std::filesystem::path path_;
  int descriptor_;
};

// Makes a rename or a new file in this folder survive a crash of the machine.
void sync_folder(const std::filesystem::path& folder);

}  // namespace taut
