#include "files/disk_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "base/errors.hpp"

namespace taut {

DiskFile::DiskFile(const std::filesystem::path& path, Opening opening, std::filesystem::path named)
    : path_(named.empty() ? path : std::move(named)),
      descriptor_(::open(path.c_str(),
                         O_CLOEXEC | (opening == kRead ? O_RDONLY : O_RDWR) |
                             (opening == kNew || opening == kEither ? O_CREAT : 0) |
                             (opening == kNew ? O_TRUNC : 0),
                         0666)) {
  if (descriptor_ < 0) refuse("open");
}

DiskFile::DiskFile(DiskFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

DiskFile::~DiskFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void DiskFile::refuse(const char* deed, const char* why) const {
  throw OutsideError(fmt::format("{}: cannot {}: {}", path_.string(), deed, why));
}

void DiskFile::refuse(const char* deed) const {
  refuse(deed, std::strerror(errno));
}

std::uint64_t DiskFile::size() const {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) refuse("read");
  return static_cast<std::uint64_t>(status.st_size);
}

std::size_t DiskFile::read(std::uint64_t at, char* into, std::size_t bytes) const {
  std::size_t done = 0;
  while (done < bytes) {
    const ssize_t got = ::pread(descriptor_, into + done, bytes - done, static_cast<off_t>(at + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse("read");
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

void DiskFile::write(std::uint64_t at, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) refuse("write");
    bytes.remove_prefix(static_cast<std::size_t>(written));
    at += static_cast<std::uint64_t>(written);
  }
}

void DiskFile::cut(std::uint64_t size) {
  if (::ftruncate(descriptor_, static_cast<off_t>(size)) != 0) refuse("cut");
}

void DiskFile::cut_quietly(std::uint64_t size) noexcept {
  [[maybe_unused]] const int ignored = ::ftruncate(descriptor_, static_cast<off_t>(size));
}

void DiskFile::sync() {
  if (::fsync(descriptor_) != 0 && errno != EINVAL) refuse("write");  // EINVAL: nothing to sync, as /dev/full
}

bool DiskFile::still_there() const {
  struct stat status {};
  return ::fstat(descriptor_, &status) == 0 && status.st_nlink > 0;
}

// Any other error means a file system without locks.
bool DiskFile::lock() {
  return ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

void sync_folder(const std::filesystem::path& folder) {
  const std::filesystem::path here = folder.empty() ? "." : folder;
  const int descriptor = ::open(here.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0)
    throw OutsideError(fmt::format("{}: cannot open the folder: {}", here.string(), std::strerror(errno)));
  const bool synced = ::fsync(descriptor) == 0 || errno == EINVAL;
  const int error = errno;
  ::close(descriptor);
  if (!synced)
    throw OutsideError(fmt::format("{}: cannot write the folder: {}", here.string(), std::strerror(error)));
}

}  // namespace taut
