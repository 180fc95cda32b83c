#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "printing.hpp"

namespace taut {
namespace {

constexpr double kFirstRow = 10;  // [s]

double time_left(double spent, long done, long total) {
  return spent / static_cast<double>(done) * static_cast<double>(total - done);
}

std::string clock_text(double seconds) {
  const long s = std::lround(seconds);
  return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

}  // namespace

Progress::Progress(long total)
    : total_(total), terminal_(isatty(STDERR_FILENO) != 0 && !quiet()), start_(Clock::now()), next_(start_) {}

void Progress::write_rows(const std::string& what) {
  if (terminal_ || quiet() || json_alone()) return;
  counted_ = what;
  const char* said = std::getenv("TAUT_PROGRESS_S");
  next_row_ = said ? std::max(0.0, std::atof(said)) : kFirstRow;
}

bool Progress::row_is_due(double spent) {
  if (counted_.empty() || spent < next_row_) return false;
  if (next_row_ > 0) next_row_ = 1.5 * spent;
  return true;
}

void Progress::show_step(long done) {
  if (!terminal_ && counted_.empty()) return;
  const auto now = Clock::now();
  const double spent = std::chrono::duration<double>(now - start_).count();
  if (done < total_ && row_is_due(spent))
    say("  {} of {} {} after {}, {} left\n", done, total_, counted_, clock_text(spent),
        clock_text(time_left(spent, done, total_)));
  if (!terminal_ || now < next_) return;
  next_ = now + std::chrono::milliseconds(200);
  draw(fmt::format("{:5.1f} %   {} left ", 100.0 * static_cast<double>(done) / static_cast<double>(total_),
                   clock_text(time_left(spent, done, total_))));
}

void Progress::show_task(const std::string& what) {
  const double spent = std::chrono::duration<double>(Clock::now() - start_).count();
  if (row_is_due(spent)) say("  {} after {}\n", what, clock_text(spent));
  draw(what + " ... ");
}

void Progress::clear() {
  if (drawn_) draw("");
  drawn_ = false;
}

// A closed terminal must not stop the run.
void Progress::draw(const std::string& line) {
  if (!terminal_) return;
  std::fputs(fmt::format("\r{}\x1b[K", line).c_str(), stderr);
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace taut
