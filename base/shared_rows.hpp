#pragma once

#include <mutex>
#include <utility>
#include <vector>

namespace taut {

// Rows that one thread appends while others read. A reader gets a copy, so that it holds the lock for no longer than
// the copy takes, and calls nothing meanwhile.
template <class T>
class SharedRows {
 public:
  void append(T row) {
    const std::scoped_lock lock(mutex_);
    rows_.push_back(std::move(row));
  }
  std::vector<T> copy() const {
    const std::scoped_lock lock(mutex_);
    return rows_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<T> rows_;
};

}  // namespace taut
