#include "files/journaled_file.hpp"

#include <algorithm>
#include <cstring>

#include "files/atomic_file.hpp"

namespace taut {
namespace {

// A journal is a list of these records, each followed by its bytes.
struct Change {
  std::uint64_t at, bytes;
};

// Calls write(address, bytes) for each change.
void carry_out(std::string_view journal, const auto& write) {
  while (journal.size() >= sizeof(Change)) {
    Change change{};
    std::memcpy(&change, journal.data(), sizeof change);
    journal.remove_prefix(sizeof change);
    write(change.at, journal.substr(0, change.bytes));
    journal.remove_prefix(std::min<std::size_t>(change.bytes, journal.size()));
  }
}

}  // namespace

JournaledFile::JournaledFile(const std::filesystem::path& path, DiskFile::Opening opening)
    : path_(path), journal_(path.string() + ".journal"), file_(path, opening) {
  size_ = settled_ = file_.size();
  const auto to_disk = [&](std::uint64_t at, std::string_view bytes) { file_.write(at, bytes); };
  const auto to_memory = [&](std::uint64_t at, std::string_view bytes) { write(at, bytes); };
  std::error_code ignored;
  if (opening != DiskFile::kNew && std::filesystem::exists(journal_, ignored)) {
    const DiskFile journal(journal_, DiskFile::kRead);
    std::string text(journal.size(), '\0');
    text.resize(journal.read(0, text.data(), text.size()));
    if (opening == DiskFile::kRead)
      carry_out(text, to_memory);
    else
      carry_out(text, to_disk), file_.sync();
  }
  if (opening == DiskFile::kRead) return;
  std::filesystem::remove(journal_, ignored);
  std::filesystem::remove(journal_.string() + ".part", ignored);
  size_ = settled_ = file_.size();
}

void JournaledFile::read(std::uint64_t at, char* into, std::size_t bytes) const {
  const std::size_t there = file_.read(at, into, bytes);
  std::fill(into + there, into + bytes, '\0');
  for (auto page = pages_.lower_bound(at / kPage * kPage); page != pages_.end(); ++page) {
    const std::uint64_t first = std::max(at, page->first);
    const std::uint64_t last = std::min({at + bytes, page->first + kPage, settled_});
    if (page->first >= at + bytes) break;
    if (first < last) std::memcpy(into + (first - at), &page->second[first - page->first], last - first);
  }
}

void JournaledFile::write_to_page(std::uint64_t at, std::string_view bytes) {
  const std::uint64_t begin = at / kPage * kPage;
  auto page = pages_.find(begin);
  if (page == pages_.end()) {
    page = pages_.try_emplace(begin).first;
    page->second.fill('\0');
    file_.read(begin, page->second.data(), kPage);
  }
  std::memcpy(&page->second[at - begin], bytes.data(), bytes.size());
}

void JournaledFile::write(std::uint64_t at, std::string_view bytes) {
  size_ = std::max(size_, at + bytes.size());
  while (!bytes.empty() && at < settled_) {
    const std::uint64_t end = std::min({at / kPage * kPage + kPage, settled_, at + bytes.size()});
    write_to_page(at, bytes.substr(0, end - at));
    bytes.remove_prefix(end - at);
    at = end;
  }
  file_.write(at, bytes);
}

void JournaledFile::commit(std::uint64_t size) {
  file_.sync();
  std::string journal;
  for (const auto& [at, page] : pages_) {
    if (at >= std::min(settled_, size)) continue;
    const Change change{at, std::min({kPage, settled_ - at, size - at})};
    journal.append(reinterpret_cast<const char*>(&change), sizeof change).append(page.data(), change.bytes);
  }
  if (!journal.empty()) {
    write_file(journal_, journal);
    carry_out(journal, [&](std::uint64_t at, std::string_view change) { file_.write(at, change); });
  }
  file_.cut(size);
  file_.sync();
  std::error_code ignored;
  std::filesystem::remove(journal_, ignored);
  pages_.clear();
  size_ = settled_ = size;
}

}  // namespace taut
