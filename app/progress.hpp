#pragma once

#include <chrono>
#include <string>

namespace taut {

// A line on a terminal; nothing where stderr is a file or a pipe, or under --quiet.
class Progress {
 public:
  explicit Progress(long total = 0);
  void show_step(long done);                 // the share done and the time left; redraws a few times a second
  void show_task(const std::string& what);  // or what is being done
  void clear();                       // takes the line away, before something else is printed

 private:
  void draw(const std::string& line);

  using Clock = std::chrono::steady_clock;
  long total_;
  bool terminal_, drawn_ = false;
  Clock::time_point start_, next_;
};

}  // namespace taut
