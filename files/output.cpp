#include "files/output.hpp"

#include "base/errors.hpp"

namespace taut {

std::uint64_t size_of(const std::filesystem::path& file) {
  std::error_code error;
  const std::uint64_t bytes = std::filesystem::file_size(file, error);
  return error ? 0 : bytes;
}

GrowingFile::GrowingFile(const std::filesystem::path& path, std::uint64_t mark)
    : file_(path, mark == 0 ? DiskFile::kNew : DiskFile::kThere), size_(mark) {
  if (mark == 0) return;
  if (file_.size() < mark) file_.refuse("go on", "it is shorter than it was at the checkpoint");
  file_.cut(mark);
}

void GrowingFile::write(std::string_view bytes) {
  try {
    file_.write(size_, bytes);
  } catch (const OutsideError&) {
    file_.cut_quietly(size_);
    throw;
  }
  size_ += bytes.size();
}

void GrowingFile::rewrite(std::uint64_t at, std::string_view bytes) {
  file_.write(at, bytes);
}

std::uint64_t GrowingFile::mark() {
  file_.sync();
  if (!file_.still_there()) file_.refuse("go on", "it was removed while it was written");
  return size_;
}

}  // namespace taut
