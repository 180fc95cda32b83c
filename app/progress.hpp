#pragma once

#include <chrono>
#include <string>

namespace taut {

// A line of progress on a terminal; nothing if stderr is a file or a pipe, or with --quiet.
class Progress {
 public:
  explicit Progress(long total = 0);
  void show_step(long done);                // the fraction done and the time left, a few times a second
  void show_task(const std::string& what);  // what is being done
  void clear();                             // removes the line before something else is printed

 private:
  void draw(const std::string& line);

  using Clock = std::chrono::steady_clock;
  long total_;
  bool terminal_, drawn_ = false;
  Clock::time_point start_, next_;
};

}  // namespace taut
