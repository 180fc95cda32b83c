#include "base/archive.hpp"

#include "base/errors.hpp"

namespace taut {

void Archive::refuse() {
  throw InputError("what it keeps is not of this system");
}

void Archive::bytes(void* data, std::size_t size) {
  if (size == 0) return;
  if (!loading()) {
    kept_->append(static_cast<const char*>(data), size);
    return;
  }
  demand(rest_.size() >= size);
  std::memcpy(data, rest_.data(), size);
  rest_.remove_prefix(size);
}

void Archive::array(void* data, std::uint64_t size) {
  std::uint64_t same = size;
  bytes(&same, sizeof same);
  demand(same == size);
  bytes(data, size);
}

void Archive::text(std::string& text) {
  std::uint64_t size = text.size();
  bytes(&size, sizeof size);
  if (loading()) {
    demand(size <= rest_.size());
    text.resize(size);
  }
  bytes(text.data(), size);
}

}  // namespace taut
