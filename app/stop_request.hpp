#pragma once

namespace taut {

// While it lives, SIGINT, SIGTERM and SIGHUP (the terminal was closed) ask to stop instead of killing. Once
// asked, a second SIGINT or SIGTERM kills at once; a hangup comes twice by itself. Under nohup, which has
// SIGHUP ignored, it stays so.
class StopRequest {
 public:
  StopRequest();
  StopRequest(const StopRequest&) = delete;
  StopRequest& operator=(const StopRequest&) = delete;
  ~StopRequest();

  void stop_for_closed_pipe() const;  // asks to stop as SIGPIPE would: nobody reads any more
  int signal() const;           // 0: none yet
};

// Thrown where a run stopped because it was asked to: the exit code a shell gives to the signal.
struct Stopped {
  int exit_code;
};

}  // namespace taut
