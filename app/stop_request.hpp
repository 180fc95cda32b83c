#pragma once

namespace taut {

// While it lives, SIGINT and SIGTERM ask to stop instead of killing. Once asked, a second one kills at once.
class StopRequest {
 public:
  StopRequest();
  StopRequest(const StopRequest&) = delete;
  StopRequest& operator=(const StopRequest&) = delete;
  ~StopRequest();

  int signal() const;  // 0: none yet
};

// Thrown where a run stopped because it was asked to: the exit code a shell gives to the signal.
struct Stopped {
  int exit_code;
};

}  // namespace taut
