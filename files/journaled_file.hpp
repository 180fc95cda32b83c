#pragma once

#include <array>
#include <map>

#include "files/disk_file.hpp"

namespace taut {

// A random-access file that is on disk at every instant as of its last commit, whenever the program or the
// machine stops. Changes below the end of the last commit stay in memory. A commit writes them to a journal
// beside the file ("<file>.journal", which is complete or absent), then to the file, and then deletes the
// journal. Data beyond the end of the last commit is written at once, because no reader looks there yet. A
// journal that is found on opening is applied first; in memory only if the file is opened for reading.
class JournaledFile {
 public:
  JournaledFile(const std::filesystem::path& path, DiskFile::Opening opening);

  std::uint64_t size() const { return size_; }
  void read(std::uint64_t at, char* into, std::size_t bytes) const;  // reads zeros beyond the end
  void write(std::uint64_t at, std::string_view bytes);
  void commit(std::uint64_t size);  // the file then has this size

  std::size_t pending() const { return pages_.size() * kPage; }  // bytes of changes in memory
  bool still_there() const { return file_.still_there(); }
  const std::filesystem::path& path() const { return path_; }

 private:
  static constexpr std::uint64_t kPage = 4096;
  using Page = std::array<char, kPage>;

  void write_to_page(std::uint64_t at, std::string_view bytes);

  std::filesystem::path path_, journal_;
  DiskFile file_;
  std::uint64_t size_, settled_;         // size now and at the last commit
  std::map<std::uint64_t, Page> pages_;  // changed pages by address; data beyond settled_ is ignored
};

}  // namespace taut
