#include "files/folder_lock.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"
#include "files/atomic_file.hpp"

namespace taut {
namespace {

std::filesystem::path made(std::filesystem::path folder) {
  make_folder(folder);
  return folder;
}

}  // namespace

FolderLock::FolderLock(std::filesystem::path folder)
    : path_(made(std::move(folder))), file_(path_ / ".lock", DiskFile::kEither) {
  if (!file_.lock())
    throw InputError(
        fmt::format("{}: another taut is still writing there; wait until it ends, or give another folder",
                    path_.string()));
}

}  // namespace taut
