#include "files/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>

#include "base/errors.hpp"
#include "base/listen.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

// The command that expands files of this ending; null: none is needed.
const char* expander(const fs::path& file) {
  const fs::path ending = file.extension();
  return ending == ".gz" ? "gzip" : ending == ".bz2" ? "bzip2" : nullptr;
}

// As one word of a shell's command.
std::string quoted(const std::string& text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? "'\\''" : std::string(1, c);
  return word + "'";
}

// A file, or what a command makes of it.
class Source {
 public:
  explicit Source(const fs::path& file) : file_(file), command_(expander(file)) {
    if (fs::is_directory(file)) refuse("cannot be read: is a folder");
    in_ = std::fopen(file.c_str(), "rbe");
    if (!in_) refuse(fmt::format("cannot be read: {}", std::strerror(errno)));
    if (!command_) return;
    std::fclose(std::exchange(in_, nullptr));
    in_ = ::popen(fmt::format("{} -dc < {} 2> /dev/null", command_, quoted(file.string())).c_str(), "re");
    if (!in_) refuse(fmt::format("{} cannot be started to expand it", command_));
  }
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  ~Source() { close(); }

  // Returns how many characters were read: fewer than `most` at the end alone.
  std::size_t read(char* to, std::size_t most) { return std::fread(to, 1, most, in_); }

  // Throws if not all could be read.
  void finish() {
    if (std::ferror(in_)) refuse("cannot be read to its end");
    constexpr int kNoSuchCommand = 127 << 8;
    const int status = close();
    if (status == kNoSuchCommand)
      refuse(fmt::format("needs the command {0}; install {0}, or expand the file", command_));
    if (status != 0) refuse(fmt::format("{} cannot expand it: is it whole?", command_));
  }

 private:
  int close() {
    std::FILE* in = std::exchange(in_, nullptr);
    return !in ? 0 : command_ ? ::pclose(in) : std::fclose(in);
  }
  [[noreturn]] void refuse(const std::string& why) const {
    std::string line = fmt::format("{}: {}", file_.string(), why);
    std::ranges::replace_if(
        line, [](unsigned char c) { return c < ' ' || c == 127; }, ' ');
    throw InputError(line);
  }

  fs::path file_;
  const char* command_;
  std::FILE* in_ = nullptr;
};

}  // namespace

fs::path without_compression(const fs::path& file) {
  return expander(file) ? file.parent_path() / file.stem() : file;
}

std::string whole_text(const fs::path& file) {
  constexpr std::size_t kLargestPiece = std::size_t(16) << 20;  // that is read at once
  Source in(file);
  std::string text;
  for (bool more = true; more && text.size() <= kLongestText;) {
    hear();
    const std::size_t before = text.size(), piece = std::clamp<std::size_t>(before, 1 << 16, kLargestPiece);
    text.resize(before + piece);
    const std::size_t read = in.read(text.data() + before, piece);
    text.resize(before + read);
    if (text.find('\0', before) != text.npos) return text;
    more = read == piece;
  }
  if (text.size() <= kLongestText) in.finish();
  return text;
}

std::string contents_of(const fs::path& file) {
  std::error_code unseen;
  if (!fs::exists(file, unseen) && !unseen) return "";
  if (fs::is_directory(file, unseen))
    throw OutsideError(fmt::format("{}: cannot be read: is a folder", file.string()));
  std::ifstream in(file, std::ios::binary);
  if (!in) throw OutsideError(fmt::format("{}: cannot be read: {}", file.string(), std::strerror(errno)));
  try {
    return {std::istreambuf_iterator<char>(in), {}};
  } catch (const std::ios_base::failure& e) {
    throw OutsideError(fmt::format("{}: cannot be read: {}", file.string(), e.what()));
  }
}

}  // namespace taut
