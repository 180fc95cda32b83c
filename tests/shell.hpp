#pragma once

// taut between a shell's streams: pipes, terminals, closed ones, and signals.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <functional>
#include <set>
#include <thread>
#include <vector>

#include "file_text.hpp"
#include "temporary_folder.hpp"

namespace taut {

using Arguments = std::vector<std::string>;

inline Arguments words(const std::string& line) {
  std::istringstream in(line);
  Arguments all;
  for (std::string word; in >> word;) all.push_back(word);
  return all;
}

// A process of taut's, ended with the test at the latest. `streams` puts its streams where they are to be, in
// the new process; its standard error else goes to a file of the folder.
class Shell {
 public:
  using Streams = std::function<void()>;

  Shell(const fs::path& folder, const Arguments& arguments, const Streams& streams)
      : error_(folder / "error") {
    pid_ = fork();
    if (pid_ == 0) execute(arguments, streams);
  }
  // In a terminal of its own: both streams.
  Shell(const fs::path& folder, const Arguments& arguments) : error_(folder / "error") {
    pid_ = forkpty(&terminal_, nullptr, nullptr, nullptr);
    if (pid_ == 0) execute(arguments, nullptr);
  }
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;
  ~Shell() {
    if (terminal_ >= 0) close(terminal_);
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }

  void send(int signal) const { kill(pid_, signal); }
  void halt() const {  // returns when it stands still
    kill(pid_, SIGSTOP);
    waitpid(pid_, nullptr, WUNTRACED);
  }
  int terminal() const { return terminal_; }
  void close_terminal() { close(std::exchange(terminal_, -1)); }
  std::string error() const { return contents(error_); }

  // The exit code as a shell has it, 128 + the signal it died of.
  int wait() {
    int status = 0;
    waitpid(std::exchange(pid_, -1), &status, 0);
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  }

  // True once the process has computed for so long, in seconds of its own; false if it has ended.
  bool has_computed(double seconds) const {
    for (;; std::this_thread::yield()) {
      const std::string stat = contents("/proc/" + std::to_string(pid_) + "/stat");
      std::istringstream fields(stat.substr(std::min(stat.size(), stat.rfind(')') + 1)));
      std::string state, ticks;
      fields >> state;
      for (int n = 0; n < 11; ++n) fields >> ticks;  // the last of them: time in user mode
      if (state == "Z") return false;
      if (std::atof(ticks.c_str()) / static_cast<double>(sysconf(_SC_CLK_TCK)) > seconds) return true;
    }
  }

 private:
  [[noreturn]] void execute(const Arguments& arguments, const Streams& streams) const {
    std::vector<char*> argv = {const_cast<char*>(TAUT_BINARY)};
    for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    if (streams) {
      dup2(open(error_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
      streams();
    }
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) std::signal(signal, SIG_DFL);
    execv(TAUT_BINARY, argv.data());
    _exit(127);
  }

  fs::path error_;
  int terminal_ = -1;
  pid_t pid_;
};

// Reads until the text holds `until`, or to the end of the file or the terminal.
inline std::string read_from(int stream, const std::string& until = "") {
  constexpr int kPatience = 300000;  // ms: only a test that fails waits for so long
  std::string text;
  std::array<char, 4096> buffer;
  while (until.empty() || text.find(until) == text.npos) {
    pollfd ready{stream, POLLIN, 0};
    if (poll(&ready, 1, kPatience) <= 0) break;
    const ssize_t got = read(stream, buffer.data(), buffer.size());
    if (got <= 0) break;
    text.append(buffer.data(), static_cast<std::size_t>(got));
  }
  return text;
}

// Two ends, closed with it.
struct Pipe {
  Pipe() { EXPECT_EQ(pipe2(ends.data(), O_CLOEXEC), 0); }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    for (int& end : ends) close_end(end);
  }
  static void close_end(int& end) {
    if (end >= 0) close(end);
    end = -1;
  }
  std::array<int, 2> ends{};
};

}  // namespace taut
