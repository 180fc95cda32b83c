#include "stop_request.hpp"

#include <csignal>

namespace taut {
namespace {

volatile std::sig_atomic_t asked = 0;  // a handler can reach nothing else

void restore() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

void ask(int signal) {
  asked = signal;
  restore();
}

}  // namespace

StopRequest::StopRequest() {
  asked = 0;
  std::signal(SIGINT, ask);
  std::signal(SIGTERM, ask);
}

StopRequest::~StopRequest() {
  restore();
}

int StopRequest::signal() const {
  return asked;
}

}  // namespace taut
