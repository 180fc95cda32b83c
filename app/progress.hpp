#pragma once

#include <chrono>
#include <string>

namespace taut {

// A line of progress on a terminal; nothing if stderr is a file or a pipe, or with --quiet.
class Progress {
 public:
  explicit Progress(long total = 0);
  // Where stderr is no terminal, print a row to the standard output now and then: after ten seconds (or those that
  // TAUT_PROGRESS_S says), then each time when half as long again has passed. what: what is counted, "trials".
  void write_rows(const std::string& what);
  void show_step(long done);                // the fraction done and the time left, a few times a second
  void show_task(const std::string& what);  // what is being done, in rows as well
  void clear();                             // removes the line before something else is printed

 private:
  void draw(const std::string& line);
  bool row_is_due(double spent);

  using Clock = std::chrono::steady_clock;
  long total_;
  bool terminal_, drawn_ = false;
  Clock::time_point start_, next_;
  std::string counted_;  // in rows; empty: there are none
  double next_row_ = 0;  // seconds from the start
};

}  // namespace taut
