#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace taut {

// A file as the system has it: nothing is kept back in buffers, and every refusal is an OutsideError that
// names the file.
class DiskFile {
 public:
  // Empty, whatever was there; as it is; as it is or else empty; as it is, to be read alone.
  enum Opening { kNew, kThere, kEither, kRead };

  // `named`: what refusals call it, where that is not its path.
  DiskFile(const std::filesystem::path& path, Opening opening, std::filesystem::path named = {});
  DiskFile(DiskFile&& other) noexcept;
  DiskFile& operator=(DiskFile&&) = delete;
  ~DiskFile();

  std::uint64_t size() const;
  std::size_t read(std::uint64_t at, char* into, std::size_t bytes) const;  // how many there were
  void write(std::uint64_t at, std::string_view bytes);
  void cut(std::uint64_t size);
  void cut_quietly(std::uint64_t size) noexcept;
  void sync();               // returns when it would outlast a crash of the machine
  bool still_there() const;  // whether any folder lists it
  bool lock();               // until it is closed; false: another process has it

  [[noreturn]] void refuse(const char* deed, const char* why) const;

 private:
  [[noreturn]] void refuse(const char* deed) const;  // why: errno

  std::filesystem::path path_;
  int descriptor_;
};

// Makes a folder's list of names (a rename, a new file) outlast a crash of the machine.
void sync_folder(const std::filesystem::path& folder);

}  // namespace taut
