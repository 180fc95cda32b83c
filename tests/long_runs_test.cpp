// Runs that are stopped, killed, or refused by the disk, as a user meets them. TAUT_KILLS=200 kills more
// often.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <thread>

#include "temporary_folder.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Arguments = std::vector<std::string>;
using std::chrono::milliseconds;

std::string contents(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

// taut as a process of its own, its streams in files.
class Process {
 public:
  Process(const Arguments& arguments, const fs::path& streams)
      : out_(streams / "out"), error_(streams / "error") {
    std::vector<char*> words = {const_cast<char*>(TAUT_BINARY)};
    for (const auto& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    pid_ = fork();
    if (pid_ != 0) return;
    dup2(open(out_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
    dup2(open(error_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
    execv(TAUT_BINARY, words.data());
    _exit(127);
  }

  void send(int signal) const { kill(pid_, signal); }

  void halt() const {  // returns when it stands still
    kill(pid_, SIGSTOP);
    waitpid(pid_, nullptr, WUNTRACED);
  }

  // The exit code, or minus the signal it died of.
  int wait() const {
    int status = 0;
    waitpid(pid_, &status, 0);
    return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
  }

  std::string out() const { return contents(out_); }
  std::string error() const { return contents(error_); }

 private:
  fs::path out_, error_;
  pid_t pid_;
};

struct Outcome {
  int code;
  std::string out, error;
};

Outcome taut(const Arguments& arguments, const fs::path& streams) {
  const Process process(arguments, streams);
  const int code = process.wait();
  return {code, process.out(), process.error()};
}

void wait_for(const fs::path& file) {
  for (int n = 0; n < 20000 && !fs::exists(file); ++n) std::this_thread::sleep_for(milliseconds(1));
}

// The log but for its speeds, column 7.
std::string steady_log(const fs::path& folder) {
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

void expect_same_run(const fs::path& a, const fs::path& b) {
  EXPECT_EQ(steady_log(a), steady_log(b));
  EXPECT_EQ(contents(a / "final.start.toml"), contents(b / "final.start.toml"));
}

// 64 waters in a droplet, a thermostat that draws, and steps enough to be killed in.
Arguments droplet(const fs::path& out, const std::string& steps) {
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

class LongRuns : public ::testing::Test {
 protected:
  fs::path in(const char* name) const { return folder_.path() / name; }
  Outcome run(const Arguments& arguments) const { return taut(arguments, folder_.path()); }

  TemporaryFolder folder_;
};

TEST_F(LongRuns, KilledAtAnyInstantTheyGoOn) {
  const char* wanted = std::getenv("TAUT_KILLS");
  const int kills = wanted ? std::atoi(wanted) : 10;
  ASSERT_EQ(run(droplet(in("whole"), "600")).code, 0);
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(run(droplet(in("timed"), "600")).code, 0);
  const double length =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();

  std::mt19937 random(1);
  int killed = 0, before_any_checkpoint = 0, runs = 0;
  while (killed < kills) {
    const fs::path out = in(("killed" + std::to_string(runs++)).c_str());
    for (int code = -SIGKILL; code == -SIGKILL;) {
      const bool resumable = fs::exists(out / "checkpoint.cbor");
      const Process process(resumable ? Arguments{"resume", out.string()} : droplet(out, "600"),
                            folder_.path());
      const double instant = length * 0.5 * static_cast<double>(random() % 1000) / 1000;
      std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(instant));
      if (killed < kills) process.send(SIGKILL);
      code = process.wait();
      killed += code == -SIGKILL;
      before_any_checkpoint += code == -SIGKILL && !fs::exists(out / "checkpoint.cbor");
      ASSERT_TRUE(code == 0 || code == -SIGKILL) << process.error();
    }
    expect_same_run(in("whole"), out);
    fs::remove_all(out);
  }
  RecordProperty("kills", killed);
  std::printf("%d kills in %d runs, %d of them before there was a checkpoint; none lost\n", killed, runs,
              before_any_checkpoint);
}

TEST_F(LongRuns, StopWhenAskedAndSayHowToGoOn) {
  ASSERT_EQ(run(droplet(in("whole"), "700")).code, 0);
  for (const int signal : {SIGINT, SIGTERM}) {
    const fs::path out = in(signal == SIGINT ? "int" : "term");
    const Process process(droplet(out, "700"), folder_.path());
    wait_for(out / "checkpoint.cbor");
    process.send(signal);
    EXPECT_EQ(process.wait(), 128 + signal) << process.error();
    EXPECT_THAT(process.out(), HasSubstr("`taut resume " + out.string() + "` goes on"));
    EXPECT_FALSE(fs::exists(out / "summary.json"));
    ASSERT_EQ(run({"resume", out.string()}).code, 0);
    expect_same_run(in("whole"), out);
  }
}

TEST_F(LongRuns, FourHundredAndSixHundredAreAThousand) {
  const fs::path out = in("parts");
  ASSERT_EQ(run(droplet(in("whole"), "1000")).code, 0);
  ASSERT_EQ(run(droplet(out, "400")).code, 0);
  const Outcome done = run({"resume", out.string()});
  EXPECT_EQ(done.code, 0);
  EXPECT_THAT(done.out, HasSubstr("all 400 steps are taken"));
  ASSERT_EQ(run({"resume", out.string(), "--steps", "600"}).code, 0);
  expect_same_run(in("whole"), out);
  const auto summary = nlohmann::json::parse(contents(out / "summary.json"));
  EXPECT_EQ(summary["steps"], 1000);
}

TEST_F(LongRuns, WhatIsNoCheckpointGetsOneLine) {
  fs::create_directories(in("bad"));
  const auto refused = [&](const std::string& bytes) {
    std::ofstream(in("bad") / "checkpoint.cbor", std::ios::binary) << bytes;
    const Outcome outcome = run({"resume", in("bad").string()});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
    EXPECT_THAT(outcome.error, HasSubstr("checkpoint.cbor: "));
  };
  EXPECT_EQ(run({"resume", in("nowhere").string()}).code, 2);
  ASSERT_EQ(run(droplet(in("good"), "20")).code, 0);
  std::string bytes = contents(in("good") / "checkpoint.cbor");
  refused("");
  refused("hello");
  refused(bytes.substr(0, bytes.size() / 2));
  bytes[bytes.size() / 2] = static_cast<char>(~bytes[bytes.size() / 2]);
  refused(bytes);
}

// The last checkpoint stays good, and the run goes on once there is room.
TEST_F(LongRuns, AFullDiskIsOneLineAndLosesNothing) {
  const fs::path out = in("full");
  ASSERT_EQ(run(droplet(in("whole"), "100")).code, 0);
  ASSERT_EQ(run(droplet(out, "50")).code, 0);
  fs::create_symlink("/dev/full", out / "checkpoint.cbor.part");
  const Outcome refused = run({"resume", out.string(), "--steps", "50"});
  EXPECT_EQ(refused.code, 3);
  EXPECT_EQ(std::count(refused.error.begin(), refused.error.end(), '\n'), 1) << refused.error;
  EXPECT_THAT(refused.error, HasSubstr("No space left on device"));
  EXPECT_EQ(run({"resume", out.string(), "--steps", "50"}).code, 0);
  expect_same_run(in("whole"), out);

  fs::create_directories(in("log"));
  fs::create_symlink("/dev/full", in("log") / "log.csv");
  EXPECT_EQ(run(droplet(in("log"), "50")).code, 3);
}

TEST_F(LongRuns, AFolderThatVanishesIsOneLine) {
  const Process process(droplet(in("gone"), "1000000"), folder_.path());
  wait_for(in("gone") / "checkpoint.cbor");
  fs::rename(in("gone"), in("moved"));
  EXPECT_EQ(process.wait(), 3);
  const std::string error = process.error();
  EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 1) << error;
  EXPECT_THAT(error, HasSubstr("gone"));
}

// A second one is turned away, and harms nothing; the lock goes with the process that died.
TEST_F(LongRuns, OneProcessAtATimeWritesToAFolder) {
  const fs::path out = in("shared");
  ASSERT_EQ(run(droplet(in("whole"), "600")).code, 0);
  const Process first(droplet(out, "600"), folder_.path());
  wait_for(out / "checkpoint.cbor");
  first.halt();
  const std::string checkpoint = contents(out / "checkpoint.cbor"), log = contents(out / "log.csv");
  for (const Arguments& second : {Arguments{"resume", out.string()}, droplet(out, "600"),
                                  Arguments{"chart", "diatomic", "--quick", "--out", out.string()},
                                  Arguments{"stability", "diatomic", "--quick", "--out", out.string()}}) {
    const Outcome refused = run(second);
    EXPECT_EQ(refused.code, 2) << second[0];
    EXPECT_EQ(refused.error,
              "taut: " + out.string() +
                  ": another taut is still writing there; wait until it ends, or give another folder\n");
  }
  EXPECT_EQ(contents(out / "checkpoint.cbor"), checkpoint);
  EXPECT_EQ(contents(out / "log.csv"), log);
  first.send(SIGKILL);
  ASSERT_EQ(first.wait(), -SIGKILL);
  ASSERT_EQ(run({"resume", out.string()}).code, 0);
  expect_same_run(in("whole"), out);
  EXPECT_EQ(run({"resume", folder_.path().string()}).code, 2);
  EXPECT_FALSE(fs::exists(folder_.path() / ".lock"));  // no run's folder: left as it was
}

TEST_F(LongRuns, AFailureIsWrittenWithTheLastGoodFrame) {
  const fs::path out = in("failed");
  const Outcome failed = run({"run", "water", "--method", "newton", "--dt-fs", "6", "--steps", "1000",
                              "--set", "run.temperature_k=3000", "--out", out.string()});
  EXPECT_EQ(failed.code, 1);
  const auto json = nlohmann::json::parse(contents(out / "failure.json"));
  EXPECT_EQ(json["last_good_frame"]["step"], json["step"].get<long>() - 1);
  for (const char* key : {"step", "time_ps", "cause", "try", "bond", "largest_force"})
    EXPECT_TRUE(json.contains(key));
  EXPECT_EQ(json["bond"]["atoms"].size(), 2u);
  EXPECT_NEAR(json["bond"]["length_before_nm"], json["bond"]["target_nm"], 1e-8);
  EXPECT_THAT(failed.error, HasSubstr("step " + std::to_string(json["step"].get<long>())));
  EXPECT_FALSE(contents(out / "log.csv").empty());
  EXPECT_EQ(run({"run", "water", "--method", "newton", "--steps", "5", "--set", "run.temperature_k=0",
                 "build.start=" + (out / "last_good.start.toml").string()})
                .code,
            0);
}

}  // namespace
}  // namespace taut
