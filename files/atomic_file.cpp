#include "files/atomic_file.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"

namespace taut {

AtomicFile::AtomicFile(std::filesystem::path path)
    : path_(std::move(path)), aside_(path_.string() + ".part") {
  file_.emplace(aside_, DiskFile::kNew, path_);
}

AtomicFile::~AtomicFile() {
  if (!file_) return;
  std::error_code ignored;
  std::filesystem::remove(aside_, ignored);
}

void AtomicFile::write(std::string_view text) {
  file_->write(size_, text);
  size_ += text.size();
}

void AtomicFile::commit() {
  file_->sync();
  std::error_code error;
  std::filesystem::rename(aside_, path_, error);
  if (error)
    throw OutsideError(
        fmt::format("{}: cannot rename to {}: {}", aside_.string(), path_.string(), error.message()));
  file_.reset();
  sync_folder(path_.parent_path());
}

void write_file(const std::filesystem::path& path, std::string_view text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace taut
