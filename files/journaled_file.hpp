#pragma once

#include <array>
#include <map>

#include "files/disk_file.hpp"

namespace taut {

// A file written here and there, which on disk is at every instant what it was at a commit, whenever the
// program or the machine stops. What lies below the end of the last commit is changed in memory only; a
// commit writes these changes to a journal beside the file ("<file>.journal", whole or not there at all),
// then over the file, then drops the journal. What lies above is written at once: nobody looks there yet.
// A journal found when the file is opened is carried out first; in memory alone where the file is only read.
class JournaledFile {
 public:
  JournaledFile(const std::filesystem::path& path, DiskFile::Opening opening);

  std::uint64_t size() const { return size_; }
  void read(std::uint64_t at, char* into, std::size_t bytes) const;  // zeros beyond the end
  void write(std::uint64_t at, std::string_view bytes);
  void commit(std::uint64_t size);  // the file ends there

  std::size_t pending() const { return pages_.size() * kPage; }  // bytes kept in memory
  bool still_there() const { return file_.still_there(); }
  const std::filesystem::path& path() const { return path_; }

 private:
  static constexpr std::uint64_t kPage = 4096;
  using Page = std::array<char, kPage>;

  void write_to_page(std::uint64_t at, std::string_view bytes);

  std::filesystem::path path_, journal_;
  DiskFile file_;
  std::uint64_t size_, settled_;         // now; at the last commit
  std::map<std::uint64_t, Page> pages_;  // changed, by address; what lies above settled_ is of no account
};

}  // namespace taut
