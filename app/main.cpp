#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "commands.hpp"
#include "md/errors.hpp"
#include "stop_request.hpp"

namespace {

// Else the first file that is opened would take the place of a stream that was closed, and be printed into.
void fill_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0) open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

int failed(int code, const std::string& why) {
  std::fputs(("taut: " + why + "\n").c_str(), stderr);
  return code;
}

int carry_out(taut::Commands& commands, int argc, char** argv) {
  try {
    return commands.act(argc, argv);
  } catch (const taut::Stopped& stopped) {
    return stopped.exit_code;
  } catch (const taut::SimulationFailure& e) {
    return failed(1, std::string("the simulation failed: ") + e.what());
  } catch (const taut::InputError& e) {
    return failed(2, e.what());
  } catch (const std::bad_alloc&) {
    return failed(3, "out of memory");
  } catch (const std::exception& e) {
    return failed(3, e.what());
  }
}

// What was printed and did not get through was not said.
int said(int code) {
  errno = 0;
  const bool flushed = std::fflush(stdout) == 0;
  if (code != 0 || (flushed && !std::ferror(stdout))) return code;
  const std::string why = errno ? std::string(": ") + std::strerror(errno) : "";
  return failed(3, "standard output: cannot write" + why);
}

}  // namespace

// Exit codes: 0 done, 1 the simulation failed, 2 the input is wrong, 3 something outside (disk, memory), 128
// + a signal where that one asked to stop.
int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file over the limit is a write that fails
  fill_closed_streams();
  taut::Commands commands(
      "taut: molecular dynamics of rigid bonds, by several methods, with what each costs and gets wrong");
  for (const auto add : {taut::add_run, taut::add_resume, taut::add_calibrate, taut::add_crosscheck,
                         taut::add_chart, taut::add_stability, taut::add_lists, taut::add_info,
                         taut::add_measure, taut::add_help, taut::add_generate})
    add(commands);
  return said(carry_out(commands, argc, argv));
}
