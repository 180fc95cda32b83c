#pragma once

#include <functional>
#include <utility>

namespace taut {

// Called all through long work. It may throw: that ends the work, and what was half made is freed.
using Listen = std::function<void()>;

// While it lives, long work on its thread calls `listen`, wherever it calls hear(); with an empty one nothing does.
class ListenScope {
 public:
  explicit ListenScope(Listen listen = {})
      : listen_(std::move(listen)), before_(std::exchange(now_, listen_ ? &listen_ : nullptr)) {}
  ~ListenScope() { now_ = before_; }
  ListenScope(const ListenScope&) = delete;
  ListenScope& operator=(const ListenScope&) = delete;

  static const Listen* now() { return now_; }

 private:
  static inline thread_local const Listen* now_ = nullptr;
  const Listen listen_;
  const Listen* const before_;
};

inline void hear() {
  if (const Listen* listen = ListenScope::now()) (*listen)();
}

// For loops with a short body: hears in one call of a thousand.
class HearSometimes {
 public:
  void operator()() {
    if (++calls_ % 1000 == 0) hear();
  }

 private:
  long calls_ = 0;
};

}  // namespace taut
