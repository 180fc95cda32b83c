#pragma once

#include <chrono>

namespace taut {

// A line with the share done and the time left on a terminal; nothing where stderr is a file or a pipe.
class Progress {
 public:
  explicit Progress(long total);
  void at(long done);  // redraws a few times a second
  void clear();        // takes the line away, before something else is printed

 private:
  using Clock = std::chrono::steady_clock;
  long total_;
  bool terminal_, drawn_ = false;
  Clock::time_point start_, next_;
};

}  // namespace taut
