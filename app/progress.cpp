#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace taut {

Progress::Progress(long total)
    : total_(total), terminal_(isatty(STDERR_FILENO) != 0), start_(Clock::now()), next_(start_) {}

void Progress::at(long done) {
  if (!terminal_) return;
  const auto now = Clock::now();
  if (now < next_) return;
  next_ = now + std::chrono::milliseconds(200);
  const double spent = std::chrono::duration<double>(now - start_).count();
  const long left = std::lround(spent / static_cast<double>(done) * static_cast<double>(total_ - done));
  fmt::print(stderr, "\r{:5.1f} %   {}:{:02}:{:02} left \x1b[K",
             100.0 * static_cast<double>(done) / static_cast<double>(total_), left / 3600, left / 60 % 60,
             left % 60);
  std::fflush(stderr);
  drawn_ = true;
}

void Progress::clear() {
  if (!drawn_) return;
  fmt::print(stderr, "\r\x1b[K");
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace taut
