#include "stop_request.hpp"

#include <csignal>
#include <initializer_list>

namespace taut {
namespace {

volatile std::sig_atomic_t asked = 0;  // global, because a handler has no other access

void ask(int signal) {
  asked = signal;
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  std::signal(SIGHUP, SIG_IGN);
}

}  // namespace

StopRequest::StopRequest() {
  asked = 0;
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, ask);
  if (std::signal(SIGHUP, ask) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

StopRequest::~StopRequest() {
  if (asked) return;
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
  if (std::signal(SIGHUP, SIG_DFL) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

void StopRequest::stop_for_closed_pipe() const {
  if (!asked) ask(SIGPIPE);
}

int StopRequest::signal() const {
  return asked;
}

}  // namespace taut
