#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <exception>
#include <new>

#include "base/errors.hpp"
#include "commands.hpp"
#include "printing.hpp"
#include "stop_request.hpp"

namespace {

// Opens /dev/null for closed standard streams. Otherwise the first file that is opened would get the stream's
// number and be printed into.
void fill_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0) open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

int failed(int code, const std::string& why) {
  taut::complain(why);
  return code;
}

int run_command(taut::Commands& commands, int argc, char** argv) {
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

}  // namespace

// Exit codes: 0 done, 1 the simulation failed, 2 the input is wrong, 3 an error outside (disk, memory), 128 +
// the number of the signal that stopped it.
int main(int argc, char** argv) {
  // Makes writes to a file over the size limit, or to a closed pipe, fail instead of killing the process.
  // Handlers are used, because child processes would inherit SIG_IGN.
  for (const int signal : {SIGXFSZ, SIGPIPE}) std::signal(signal, [](int) {});
  fill_closed_streams();
  taut::Commands commands(
      "taut: molecular dynamics of rigid bonds, by several methods, with what each costs and gets wrong");
  for (const auto add :
       {taut::add_run, taut::add_resume, taut::add_calibrate, taut::add_crosscheck, taut::add_chart,
        taut::add_stability, taut::add_lists, taut::add_info, taut::add_measure, taut::add_plot,
        taut::add_scan, taut::add_help, taut::add_generate})
    add(commands);
  return run_command(commands, argc, argv);
}
