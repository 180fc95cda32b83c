#include "md/memory.hpp"

#include "md/errors.hpp"

namespace taut {

void Memory::refuse() {
  throw InputError("what it remembers is not of this system");
}

void Memory::bytes(void* data, std::size_t size) {
  if (size == 0) return;
  if (!recalling()) {
    kept_->append(static_cast<const char*>(data), size);
    return;
  }
  demand(rest_.size() >= size);
  std::memcpy(data, rest_.data(), size);
  rest_.remove_prefix(size);
}

void Memory::array(void* data, std::uint64_t size) {
  std::uint64_t same = size;
  bytes(&same, sizeof same);
  demand(same == size);
  bytes(data, size);
}

void Memory::text(std::string& text) {
  std::uint64_t size = text.size();
  bytes(&size, sizeof size);
  if (recalling()) {
    demand(size <= rest_.size());
    text.resize(size);
  }
  bytes(text.data(), size);
}

}  // namespace taut
