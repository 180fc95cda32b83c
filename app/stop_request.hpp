#pragma once

namespace taut {

// While this object exists, SIGINT, SIGTERM and SIGHUP (a closed terminal) request a stop instead of killing
// the process. A second SIGINT or SIGTERM kills at once; a second SIGHUP does not, because terminals send
// two. A SIGHUP that nohup ignores stays ignored.
class StopRequest {
 public:
  StopRequest();
  StopRequest(const StopRequest&) = delete;
  StopRequest& operator=(const StopRequest&) = delete;
  ~StopRequest();

  void stop_for_closed_pipe() const;  // requests a stop as SIGPIPE would: the reader has closed the pipe
  int signal() const;                 // 0 if there was none
};

// Thrown after a requested stop; has the exit code that a shell gives for the signal.
struct Stopped {
  int exit_code;
};

}  // namespace taut
