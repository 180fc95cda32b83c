#include "printing.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

#include "base/errors.hpp"
#include "stop_request.hpp"

namespace taut {
namespace {

bool quietly = false, only_json = false;  // global, as are the process's streams

// Returns 0, or the error number if not all was written.
int write_to(int stream, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = write(stream, text.data(), text.size());
    if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
    if (written >= 0 || errno == EINTR) continue;
    if (errno != EAGAIN) return errno;
    pollfd room{stream, POLLOUT, 0};  // the stream is non-blocking, set so by another process that shares it
    poll(&room, 1, -1);
  }
  return 0;
}

}  // namespace

void print_errors_and_doubts_alone() {
  quietly = true;
}

void print_json_alone() {
  only_json = true;
}

bool quiet() {
  return quietly;
}

bool json_alone() {
  return only_json;
}

int terminal_width() {
  constexpr int kNeverWrapped = 1 << 20;
  if (const char* said = std::getenv("COLUMNS")) return std::max(40, std::atoi(said));
  winsize size{};
  if (!isatty(STDOUT_FILENO) || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0)
    return kNeverWrapped;
  return std::clamp(static_cast<int>(size.ws_col), 40, 120);
}

void say_text(std::string_view text) {
  if (!quietly && !only_json) write_out(text);
}

void say_always(std::string_view text) {
  if (!quietly && !only_json) return write_out(text);
  write_to(STDERR_FILENO, text);
}

void write_out(std::string_view text) {
  const int error = write_to(STDOUT_FILENO, text);
  if (error == EPIPE) throw Stopped{128 + SIGPIPE};
  if (error != 0) throw OutsideError(fmt::format("standard output: cannot write: {}", std::strerror(error)));
}

// What is no UTF-8 in it is written as U+FFFD.
void write_json(const nlohmann::ordered_json& json) {
  write_out(json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

void complain(std::string_view why) {
  write_to(STDERR_FILENO, fmt::format("taut: {}\n", why));
}

}  // namespace taut
