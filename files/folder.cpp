#include "files/folder.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& path, const char* deed, const std::error_code& error) {
  throw OutsideError(fmt::format("{}: cannot {}: {}", path.string(), deed, error.message()));
}

fs::path new_folder_beside(const fs::path& folder) {
  for (int n = 1;; ++n) {
    const fs::path beside = folder.string() + "." + std::to_string(n);
    std::error_code error;
    if (fs::create_directory(beside, error)) return beside;
    if (error && error != std::errc::file_exists) refuse(beside, "make the folder", error);
  }
}

fs::path make_and_return(fs::path folder) {
  make_folder(folder);
  return folder;
}

}  // namespace

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw OutsideError(fmt::format("{}: cannot make the folder: {}", folder.string(), error.message()));
}

FolderLock::FolderLock(fs::path folder)
    : path_(make_and_return(std::move(folder))), file_(path_ / ".lock", DiskFile::kEither) {
  if (!file_.lock())
    throw InputError(
        fmt::format("{}: another taut is still writing there; wait until it ends, or give another folder",
                    path_.string()));
}

std::vector<std::string> list_present(const fs::path& folder, const std::vector<std::string>& names) {
  std::vector<std::string> there;
  std::error_code ignored;
  for (const std::string& name : names)
    if (fs::exists(fs::symlink_status(folder / name, ignored))) there.push_back(name);
  return there;
}

// Links are followed because a rename cannot move files to another disk.
fs::path backup_base(const fs::path& folder) {
  const fs::path plain = folder.has_filename() ? folder : folder.parent_path();
  std::error_code error;
  const fs::path name = plain.filename();
  if (name != "." && name != ".." && fs::is_directory(fs::symlink_status(plain, error))) return plain;
  const fs::path real = fs::canonical(folder, error);
  if (error) refuse(folder, "open the folder", error);
  return real;
}

fs::path move_to_backup(const fs::path& folder, const std::vector<std::string>& names) {
  const fs::path from = backup_base(folder), to = new_folder_beside(from);
  for (const std::string& name : names) {
    std::error_code error;
    fs::rename(from / name, to / name, error);
    if (error) refuse(from / name, "move", error);
  }
  sync_folder(to);
  sync_folder(from);
  sync_folder(to.parent_path());
  return to;
}

}  // namespace taut
