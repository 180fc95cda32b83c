#pragma once

// The command as a process that is stopped, killed or left alone, and what its folder then holds.

#include <chrono>
#include <map>
#include <nlohmann/json.hpp>

#include "shell.hpp"

namespace taut {

using ::testing::HasSubstr;
using ::testing::Not;

// taut as a process of its own, its streams in files.
class Process : public Shell {
 public:
  Process(const Arguments& arguments, const fs::path& streams)
      : Shell(streams, arguments,
              [&] {
                dup2(open((streams / "out").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
              }),
        out_(streams / "out") {}
  std::string out() const { return contents(out_); }

 private:
  fs::path out_;
};

struct Ending {
  int code;
  std::string out, error;
};

inline Ending run_taut(const Arguments& arguments, const fs::path& streams) {
  Process process(arguments, streams);
  const int code = process.wait();
  return {code, process.out(), process.error()};
}

inline void wait_until(const auto& so) {
  for (int n = 0; n < 20000 && !so(); ++n) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

inline void wait_for(const fs::path& file) {
  wait_until([&] { return fs::exists(file); });
}

inline void wait_for_log(const fs::path& folder, std::uintmax_t bytes) {
  wait_for(folder / "checkpoint.cbor");
  wait_until([&] { return fs::file_size(folder / "log.csv") > bytes; });
}

// What a run gets that is killed after a while.
inline void kill_when_the_log_has(std::uintmax_t bytes, Process& process, const fs::path& folder) {
  wait_for_log(folder, bytes);
  process.send(SIGKILL);
  ASSERT_EQ(process.wait(), 128 + SIGKILL);
}

inline std::map<std::string, std::string> all_files(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder))
    files[entry.path().filename().string()] = contents(entry.path());
  return files;
}

inline void expect_one_line(const Ending& outcome, int code) {
  EXPECT_EQ(outcome.code, code) << outcome.error;
  EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
}

// The log but for its speeds, column 7.
inline std::string steady_log(const fs::path& folder) {
  std::istringstream log(contents(folder / "log.csv"));
  std::string text;
  for (std::string line; std::getline(log, line);) {
    std::istringstream cells(line);
    std::string cell;
    for (int column = 1; std::getline(cells, cell, ','); ++column)
      if (column != 7) text += cell + ",";
    text += "\n";
  }
  return text;
}

// But for the times it took.
inline nlohmann::json steady_summary(const fs::path& folder) {
  auto summary = nlohmann::json::parse(contents(folder / "summary.json"));
  for (const char* time : {"us_per_step", "constraint_us_per_step", "ns_per_day"}) summary.erase(time);
  return summary;
}

inline void expect_same_run(const fs::path& a, const fs::path& b) {
  EXPECT_EQ(steady_log(a), steady_log(b));
  EXPECT_EQ(steady_summary(a), steady_summary(b));
  EXPECT_EQ(contents(a / "final.start.toml"), contents(b / "final.start.toml"));
}

// 64 waters in a droplet, a thermostat that draws, and steps enough to be killed in.
inline Arguments droplet(const fs::path& out, const std::string& steps) {
  return {"run",
          "water_cluster",
          "--method",
          "rattle",
          "--steps",
          steps,
          "--set",
          "run.log_every=7",
          "run.thermostat_ps=0.1",
          "run.temperature_k=250",
          "run.checkpoint_every=20",
          "--out",
          out.string()};
}

inline Arguments by_the_clock(const fs::path& out, const std::string& steps, const char* minutes) {
  return {"run",
          "diatomic",
          "--steps",
          steps,
          "--set",
          "run.log_every=10",
          std::string("run.checkpoint_minutes=") + minutes,
          "--out",
          out.string()};
}

inline Arguments with(Arguments arguments, const Arguments& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

class LongRuns : public ::testing::Test {
 protected:
  fs::path in(const char* name) const { return folder_.path() / name; }
  Ending run(const Arguments& arguments) const { return run_taut(arguments, folder_.path()); }

  TemporaryFolder folder_;
};

}  // namespace taut
