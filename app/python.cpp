#include "python.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "base/errors.hpp"
#include "stop_request.hpp"

extern char** environ;

namespace taut {
namespace {

// A file without a name: no pipe that both ends wait for, nothing that is left behind.
class Scratch {
 public:
  Scratch() : file_(std::tmpfile(), &std::fclose) {
    if (!file_) throw OutsideError(fmt::format("no temporary file: {}", std::strerror(errno)));
  }
  int descriptor() const { return fileno(file_.get()); }
  void write(const std::string& text) {
    const bool good = std::fwrite(text.data(), 1, text.size(), file_.get()) == text.size();
    if (!good || std::fflush(file_.get()) != 0)
      throw OutsideError(fmt::format("no room for a temporary file: {}", std::strerror(errno)));
    std::rewind(file_.get());
  }
  std::string read() {
    std::rewind(file_.get());
    std::string text;
    char buffer[4096];
    while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, file_.get())) text.append(buffer, n);
    return text;
  }

 private:
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
};

}  // namespace

std::vector<std::string> python_interpreters() {
  if (const char* said = std::getenv("TAUT_PYTHON")) return {said};
  return {TAUT_PYTHON, "python3"};
}

PythonEnd run_python(const std::string& interpreter, const std::filesystem::path& script,
                     const std::string& input) {
  Scratch in, out, error;
  in.write(input);
  std::string program = interpreter, no_bytecode = "-B", path = script.string();  // nothing beside the script
  char* argv[] = {program.data(), no_bytecode.data(), path.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in.descriptor(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out.descriptor(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, error.descriptor(), STDERR_FILENO);
  pid_t child = 0;
  const int refused = posix_spawnp(&child, program.c_str(), &actions, nullptr, argv, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (refused != 0) return {127, "", std::strerror(refused)};
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  const int code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  if (code == 128 + SIGINT) throw Stopped{code};  // Ctrl-C reaches both
  return {code, out.read(), error.read()};
}

}  // namespace taut
