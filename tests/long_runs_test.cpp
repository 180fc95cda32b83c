// Runs that are stopped, killed, or refused by the disk, as a user meets them. TAUT_KILLS=200 kills more
// often.

#include "long_runs.hpp"

#include <sys/resource.h>

#include <cstdlib>
#include <random>

namespace taut::long_runs_tests {
namespace {

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
      const Process process(with(droplet(out, "600"), {"--continue"}), folder_.path());
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
  ASSERT_EQ(run(droplet(in("whole"), "2000")).code, 0);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const fs::path out = in(std::to_string(signal).c_str());
    const Process process(droplet(out, "2000"), folder_.path());
    wait_for(out / "checkpoint.cbor");
    process.send(signal);
    if (signal == SIGHUP) process.send(signal);  // from the shell, and from the terminal
    EXPECT_EQ(process.wait(), 128 + signal) << process.error();
    EXPECT_THAT(process.out(), HasSubstr("`taut resume " + out.string() + "` goes on from step "));
    EXPECT_FALSE(fs::exists(out / "summary.json"));
    const Ending resumed = run({"resume", out.string()});
    ASSERT_EQ(resumed.code, 0);
    EXPECT_THAT(resumed.out, HasSubstr("\ngoes on from step "));
    expect_same_run(in("whole"), out);
  }
}

TEST_F(LongRuns, FourHundredAndSixHundredAreAThousand) {
  const fs::path out = in("parts");
  ASSERT_EQ(run(droplet(in("whole"), "1000")).code, 0);
  ASSERT_EQ(run(droplet(out, "400")).code, 0);
  const Ending done = run({"resume", out.string()});
  EXPECT_EQ(done.code, 0);
  EXPECT_THAT(done.out, HasSubstr("all 400 steps are taken"));
  ASSERT_EQ(run({"resume", out.string(), "--steps", "600"}).code, 0);
  expect_same_run(in("whole"), out);
  const auto summary = nlohmann::json::parse(contents(out / "summary.json"));
  EXPECT_EQ(summary["steps"], 1000);
}

// The last checkpoint stays good, and the run goes on once there is room.
TEST_F(LongRuns, AFullDiskIsOneLineAndLosesNothing) {
  const fs::path out = in("full");
  ASSERT_EQ(run(droplet(in("whole"), "100")).code, 0);
  ASSERT_EQ(run(droplet(out, "50")).code, 0);
  fs::create_symlink("/dev/full", out / "checkpoint.cbor.part");
  const Ending refused = run({"resume", out.string(), "--steps", "50"});
  expect_one_line(refused, 3);
  EXPECT_THAT(refused.error, HasSubstr("No space left on device"));
  EXPECT_EQ(run({"resume", out.string(), "--steps", "50"}).code, 0);
  expect_same_run(in("whole"), out);

  EXPECT_THAT(refused.error, HasSubstr("`taut resume " + out.string() + "` goes on from step 50"));
}

// As a disk that fills up: no file may grow beyond so many bytes.
TEST_F(LongRuns, ADiskThatFillsUpLeavesTheLastCheckpoint) {
  const fs::path out = in("full");
  const Arguments small = {
      "run", "pendulum", "--steps", "5000", "--set", "run.log_every=5", "run.checkpoint_every=100", "--out"};
  ASSERT_EQ(run(with(small, {in("small").string()})).code, 0);
  const rlimit limit{fs::file_size(in("small") / "log.csv") / 2, RLIM_INFINITY};
  setrlimit(RLIMIT_FSIZE, &limit);
  const Ending full = run(with(small, {out.string()}));
  const rlimit none{RLIM_INFINITY, RLIM_INFINITY};
  setrlimit(RLIMIT_FSIZE, &none);
  expect_one_line(full, 3);
  EXPECT_THAT(full.error, HasSubstr("log.csv: cannot write: File too large; that mended, `taut resume " +
                                    out.string() + "` goes on from step "));
  ASSERT_EQ(run({"resume", out.string()}).code, 0);
  expect_same_run(in("small"), out);
}

// The advice is what `taut resume` takes: where the last checkpoint is far behind, it cuts back only if told to.
TEST_F(LongRuns, ADiskThatFillsUpLongAfterTheLastCheckpointSaysSo) {
  const fs::path out = in("full");
  const Arguments far = {"run", "pendulum", "--steps", "5000", "--set", "run.log_every=5", "--out"};
  ASSERT_EQ(run(with(far, {in("far").string()})).code, 0);
  const rlimit limit{fs::file_size(in("far") / "log.csv") / 2, RLIM_INFINITY};
  setrlimit(RLIMIT_FSIZE, &limit);
  const Ending full = run(with(far, {out.string()}));
  const rlimit none{RLIM_INFINITY, RLIM_INFINITY};
  setrlimit(RLIMIT_FSIZE, &none);
  expect_one_line(full, 3);
  EXPECT_THAT(full.error, HasSubstr("that mended, `taut resume " + out.string() +
                                    " --yes` goes on from step 0, for which log.csv is cut back to there"));
  EXPECT_EQ(run({"resume", out.string()}).code, 2);
  ASSERT_EQ(run({"resume", out.string(), "--yes"}).code, 0);
  expect_same_run(in("far"), out);
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

TEST_F(LongRuns, AFailureIsWrittenWithTheLastGoodFrame) {
  const fs::path out = in("failed");
  const Ending failed = run({"run", "water", "--method", "newton", "--dt-fs", "6", "--steps", "1000", "--set",
                             "run.temperature_k=3000", "--out", out.string()});
  EXPECT_EQ(failed.code, 1);
  const auto json = nlohmann::json::parse(contents(out / "failure.json"));
  EXPECT_EQ(json["last_good_frame"]["step"], json["step"].get<long>() - 1);
  for (const char* key : {"step", "time_ps", "cause", "try", "bond", "largest_force"})
    EXPECT_TRUE(json.contains(key));
  EXPECT_EQ(json["bond"]["atoms"].size(), 2u);
  EXPECT_NEAR(json["bond"]["length_before_nm"], json["bond"]["target_nm"], 1e-8);
  EXPECT_THAT(failed.error, HasSubstr("step " + std::to_string(json["step"].get<long>())));
  EXPECT_THAT(failed.error, HasSubstr(out.string() + "/last_good.start.toml"));
  EXPECT_THAT(failed.error, HasSubstr("`taut resume " + out.string() + "` goes on from step "));
  EXPECT_FALSE(contents(out / "log.csv").empty());
  EXPECT_EQ(run({"run", "water", "--method", "newton", "--steps", "5", "--set", "run.temperature_k=0",
                 "build.start=" + (out / "last_good.start.toml").string()})
                .code,
            0);
}

TEST_F(LongRuns, CheckpointsAreTakenByTheClock) {
  ASSERT_EQ(run(by_the_clock(in("whole"), "200000", "0")).code, 0);
  const fs::path out = in("killed");
  const Process process(by_the_clock(out, "200000", "0.0001"), folder_.path());
  kill_when_the_log_has(1000000, process, out);
  const Ending resumed = run({"resume", out.string()});
  ASSERT_EQ(resumed.code, 0) << resumed.error;
  EXPECT_THAT(resumed.out, HasSubstr("goes on from step "));
  EXPECT_THAT(resumed.out, Not(HasSubstr("goes on from step 0\n")));
  expect_same_run(in("whole"), out);
}

// Nobody has to say so.
TEST_F(LongRuns, TheFirstCheckpointsComeSoon) {
  const fs::path out = in("killed");
  const Process process(
      {"run", "diatomic", "--steps", "1000000000", "--set", "run.log_every=1000", "--out", out.string()},
      folder_.path());
  wait_for(out / "checkpoint.cbor");
  const auto first = fs::last_write_time(out / "checkpoint.cbor");
  wait_until([&] { return fs::last_write_time(out / "checkpoint.cbor") > first; });
  process.send(SIGKILL);
  process.wait();
  const Ending resumed = run({"resume", out.string(), "--set", "run.steps=0"});
  EXPECT_THAT(resumed.out, ::testing::ContainsRegex("goes on from step [1-9]")) << resumed.error;
}

}  // namespace
}  // namespace taut::long_runs_tests
