#pragma once

#include <functional>

namespace taut {

// Called all through long work. It may throw: that ends the work, and what was half made is freed.
using Listen = std::function<void()>;

inline void hear(const Listen& listen) {
  if (listen) listen();
}

// For loops with a short body: listens in one call of a thousand.
class ListenSometimes {
 public:
  explicit ListenSometimes(const Listen& listen) : listen_(listen) {}
  void operator()() {
    if (++calls_ % 1000 == 0) hear(listen_);
  }

 private:
  const Listen& listen_;
  long calls_ = 0;
};

}  // namespace taut
