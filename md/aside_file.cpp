#include "md/aside_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

#include "md/errors.hpp"

namespace taut {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const char* deed) {
  throw OutsideError(fmt::format("{}: cannot {}: {}", path.string(), deed, std::strerror(errno)));
}

}  // namespace

AsideFile::AsideFile(std::filesystem::path path) : path_(std::move(path)), aside_(path_.string() + ".part") {
  out_.open(aside_);
  if (!out_) refuse(aside_, "write");
}

AsideFile::~AsideFile() {
  if (committed_) return;
  out_.close();
  std::error_code ignored;
  std::filesystem::remove(aside_, ignored);
}

void AsideFile::write(std::string_view text) {
  out_ << text << std::flush;
  if (!out_) refuse(aside_, "write");
}

void AsideFile::commit() {
  out_.close();
  if (!out_) refuse(aside_, "write");
  std::error_code error;
  std::filesystem::rename(aside_, path_, error);
  if (error)
    throw OutsideError(
        fmt::format("{}: cannot rename to {}: {}", aside_.string(), path_.string(), error.message()));
  committed_ = true;
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw OutsideError(fmt::format("{}: cannot make the folder: {}", folder.string(), error.message()));
}

}  // namespace taut
