#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

#include "printing.hpp"

namespace taut {

Progress::Progress(long total)
    : total_(total), terminal_(isatty(STDERR_FILENO) != 0 && !quiet()), start_(Clock::now()), next_(start_) {}

void Progress::show_step(long done) {
  if (!terminal_) return;
  const auto now = Clock::now();
  if (now < next_) return;
  next_ = now + std::chrono::milliseconds(200);
  const double spent = std::chrono::duration<double>(now - start_).count();
  const long left = std::lround(spent / static_cast<double>(done) * static_cast<double>(total_ - done));
  draw(fmt::format("{:5.1f} %   {}:{:02}:{:02} left ",
                   100.0 * static_cast<double>(done) / static_cast<double>(total_), left / 3600,
                   left / 60 % 60, left % 60));
}

void Progress::show_task(const std::string& what) {
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
