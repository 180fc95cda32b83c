// Runs that are stopped, killed, or refused by the disk, as a user meets them (TAUT_KILLS=200 kills more often), and their
// folders: gone on with, refused, moved aside, changed in what may change.

#include "long_runs.hpp"

#include <sys/resource.h>

#include <cstdlib>
#include <random>

#include "files/h5md_file.hpp"

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
    for (int code = 128 + SIGKILL; code == 128 + SIGKILL;) {
      Process process(with(droplet(out, "600"), {"--continue"}), folder_.path());
      const double instant = length * 0.5 * static_cast<double>(random() % 1000) / 1000;
      std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(instant));
      if (killed < kills) process.send(SIGKILL);
      code = process.wait();
      killed += code == 128 + SIGKILL;
      before_any_checkpoint += code == 128 + SIGKILL && !fs::exists(out / "checkpoint.cbor");
      ASSERT_TRUE(code == 0 || code == 128 + SIGKILL) << process.error();
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
    Process process(droplet(out, "2000"), folder_.path());
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
  const auto before = all_files(out);
  const Ending refused = run({"resume", out.string()});
  expect_one_line(refused, 2);
  EXPECT_THAT(refused.error, HasSubstr("log.csv is cut back to less than half"));
  EXPECT_EQ(all_files(out), before);
  ASSERT_EQ(run({"resume", out.string(), "--yes"}).code, 0);
  expect_same_run(in("far"), out);
}

TEST_F(LongRuns, AFolderThatVanishesIsOneLine) {
  Process process(droplet(in("gone"), "1000000"), folder_.path());
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
  Process process(by_the_clock(out, "200000", "0.0001"), folder_.path());
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
  Process process(
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

class RunFolders : public LongRuns {};

TEST_F(RunFolders, WhatIsNoCheckpointGetsOneLine) {
  EXPECT_EQ(run({"resume", in("nowhere").string()}).code, 2);
  fs::create_directories(in("bad"));
  std::ofstream(in("bad") / "checkpoint.cbor") << "hello";
  const Ending outcome = run({"resume", in("bad").string()});
  expect_one_line(outcome, 2);
  EXPECT_THAT(outcome.error, HasSubstr("checkpoint.cbor: "));
}

// A second one is turned away, and harms nothing; the lock goes with the process that died.
TEST_F(RunFolders, OneProcessAtATimeWritesToAFolder) {
  const fs::path out = in("shared");
  ASSERT_EQ(run(droplet(in("whole"), "2000")).code, 0);
  Process first(droplet(out, "2000"), folder_.path());
  wait_for_log(out, 3000);  // more than it would ask for before it cuts it off
  first.halt();
  const std::string checkpoint = contents(out / "checkpoint.cbor"), log = contents(out / "log.csv");
  for (const Arguments& second :
       {Arguments{"resume", out.string()}, with(droplet(out, "2000"), {"--continue"}),
        with(droplet(out, "2000"), {"--overwrite"}),
        Arguments{"chart", "diatomic", "--quick", "--out", out.string()}}) {
    const Ending refused = run(second);
    EXPECT_EQ(refused.code, 2) << second[0];
    EXPECT_EQ(refused.error,
              "taut: " + out.string() +
                  ": another taut is still writing there; wait until it ends, or give another folder\n");
  }
  EXPECT_EQ(contents(out / "checkpoint.cbor"), checkpoint);
  EXPECT_EQ(contents(out / "log.csv"), log);
  first.send(SIGKILL);
  ASSERT_EQ(first.wait(), 128 + SIGKILL);
  ASSERT_EQ(run({"resume", out.string()}).code, 0);
  expect_same_run(in("whole"), out);
  EXPECT_EQ(run({"resume", folder_.path().string()}).code, 2);
  EXPECT_FALSE(fs::exists(folder_.path() / ".lock"));  // no run's folder: left as it was
}

TEST_F(RunFolders, ARunIsNotOverwrittenUnasked) {
  const fs::path out = in("runs");
  ASSERT_EQ(run(droplet(out, "40")).code, 0);
  std::ofstream(out / "notes.txt") << "mine";
  const auto before = all_files(out);
  const Ending refused = run(droplet(out, "60"));
  expect_one_line(refused, 2);
  EXPECT_THAT(refused.error, HasSubstr("--continue"));
  EXPECT_THAT(refused.error, HasSubstr("--overwrite"));
  EXPECT_EQ(all_files(out), before);

  const Ending anew = run(with(droplet(out, "60"), {"--overwrite"}));
  ASSERT_EQ(anew.code, 0);
  EXPECT_THAT(anew.out, HasSubstr("what was there is kept in " + fs::canonical(out).string() + ".1\n"));
  auto kept = all_files(out.string() + ".1");
  kept.merge(std::map<std::string, std::string>{{"notes.txt", "mine"}, {".lock", ""}});
  EXPECT_EQ(kept, before);
  EXPECT_EQ(contents(out / "notes.txt"), "mine");
  EXPECT_EQ(steady_summary(out)["steps"], 60);
  const Ending for_programs = run(with(droplet(out, "20"), {"--overwrite", "--json"}));
  ASSERT_EQ(for_programs.code, 0);
  EXPECT_TRUE(nlohmann::json::accept(for_programs.out)) << "what is moved aside is told to people alone";
  EXPECT_EQ(steady_summary(out.string() + ".2")["steps"], 60);
}

// log.csv is not a run's alone.
TEST_F(RunFolders, FilesOfOthersAreNotOverwrittenUnasked) {
  const fs::path out = in("mine");
  fs::create_directories(out);
  for (const char* name : {"log.csv", ".lock"}) std::ofstream(out / name) << "mine";
  expect_one_line(run(droplet(out, "20")), 2);
  EXPECT_EQ(contents(out / "log.csv"), "mine");
  ASSERT_EQ(run(with(droplet(out, "20"), {"--continue"})).code, 0);
  EXPECT_EQ(contents(out.string() + ".1/log.csv"), "mine");
  EXPECT_EQ(contents(out / ".lock"), "mine");
}

TEST_F(RunFolders, ContinueIsWhatAQueueNeeds) {
  const fs::path out = in("queued");
  ASSERT_EQ(run(with(droplet(out, "40"), {"--continue"})).code, 0);
  const auto done = all_files(out);
  const Ending again = run(with(droplet(out, "40"), {"--continue"}));
  EXPECT_EQ(again.code, 0);
  EXPECT_THAT(again.out, HasSubstr("all 40 steps are taken"));
  EXPECT_EQ(all_files(out), done);
  for (const Arguments& other :
       {Arguments{"--dt-fs", "0.25"}, {"--set", "run.seed=9"}, {"--set", "method.tolerance=1e-9"}}) {
    const Ending refused = run(with(droplet(out, "40"), with(other, {"--continue"})));
    expect_one_line(refused, 2);
    EXPECT_THAT(refused.error, ::testing::ContainsRegex("(dt_fs|seed|tolerance) is "));
  }
  EXPECT_EQ(all_files(out), done);
  ASSERT_EQ(run(with(droplet(out, "100"), {"--continue"})).code, 0);
  ASSERT_EQ(run(droplet(in("whole"), "100")).code, 0);
  expect_same_run(in("whole"), out);
  EXPECT_EQ(run({"run", "pair", "--continue"}).code, 2);  // of which folder?
}

TEST_F(RunFolders, AnOutputThatIsGoneIsPutBackOrBegunAnew) {
  if (!built_with_hdf5()) GTEST_SKIP() << "built without HDF5";
  const fs::path out = in("parts");
  ASSERT_EQ(run(with(droplet(out, "40"), {"--set", "run.trajectory_every=5", "run.trajectory=both"})).code,
            0);
  // A journal, as a crash of the machine leaves one: the first eight bytes again.
  const std::uint64_t change[] = {0, 8};
  std::ofstream(out / "trajectory.h5md.journal", std::ios::binary)
      << std::string(reinterpret_cast<const char*>(change), sizeof change) << "\x89HDF\r\n\x1a\n";
  for (const char* name : {"trajectory.dcd", "trajectory.h5md", "log.csv"}) {
    fs::rename(out / name, in(name));
    const auto before = all_files(out);
    const Ending refused = run({"resume", out.string(), "--steps", "20"});
    expect_one_line(refused, 3);
    EXPECT_THAT(refused.error, HasSubstr(std::string(": ") + name + "; put it back, or `taut resume " +
                                         out.string() + " --yes` begins it anew"));
    EXPECT_EQ(all_files(out), before);
    if (name != std::string("log.csv")) fs::rename(in(name), out / name);
  }
  ASSERT_EQ(run({"resume", out.string(), "--steps", "20", "--yes"}).code, 0);
  EXPECT_THAT(contents(out / "log.csv"), ::testing::StartsWith("#\"Step\""));
  EXPECT_THAT(contents(out / "log.csv"), HasSubstr("\n42,"));
}

TEST_F(RunFolders, AStartOfAnyNameIsRemembered) {
  ASSERT_EQ(run({"run", "water", "--steps", "5", "--out", in("first").string()}).code, 0);
  const fs::path start = in("a \"good\" \\start.toml"), out = in("second");
  fs::copy(in("first") / "final.start.toml", start);
  ASSERT_EQ(
      run({"run", "water", "--steps", "5", "--set", "build.start=" + start.string(), "--out", out.string()})
          .code,
      0);
  EXPECT_EQ(run({"resume", out.string(), "--steps", "5"}).code, 0);
}

TEST_F(RunFolders, WhatMayChangeChangesAndTheRestIsRefused) {
  const fs::path out = in("changed");
  ASSERT_EQ(run(with(droplet(out, "40"), {"--set", "run.trajectory_every=10"})).code, 0);
  const auto before = all_files(out);
  for (const std::string key :
       {"run.seed=3", "build.molecules=27", "forcefield.cutoff_nm=0.8", "run.minimise=true"}) {
    const Ending refused = run({"resume", out.string(), "--steps", "20", "--set", key});
    expect_one_line(refused, 2);
    EXPECT_THAT(refused.error, HasSubstr(key.substr(0, key.find('=')) + " cannot change"));
  }
  expect_one_line(run({"resume", out.string(), "--steps", "20", "--set", "run.trajectory_every=4"}), 2);
  expect_one_line(run({"resume", out.string(), "--steps", "9223372036854775807"}), 2);
  const Ending twice = run({"resume", out.string(), "--set", "run.log_every=5", "run.log_every=10"});
  expect_one_line(twice, 2);
  EXPECT_THAT(twice.error, HasSubstr("run.log_every is said twice"));
  EXPECT_EQ(all_files(out), before);

  ASSERT_EQ(
      run({"resume", out.string(), "--steps", "20", "--set", "run.log_every=10", "run.trajectory_every=0"})
          .code,
      0);
  EXPECT_THAT(contents(out / "log.csv"), HasSubstr("\n35,"));
  EXPECT_THAT(contents(out / "log.csv"), Not(HasSubstr("\n42,")));
  EXPECT_THAT(contents(out / "log.csv"), HasSubstr("\n50,"));
  EXPECT_EQ(contents(out / "trajectory.dcd"), before.at("trajectory.dcd"));

  // A trajectory begun again does not take the place of the one before; another thermostat is not refused.
  const Ending again = run({"resume", out.string(), "--steps", "20", "--set", "run.trajectory_every=4",
                            "run.thermostat=langevin", "run.friction_per_ps=5", "run.temperature_k=310"});
  ASSERT_EQ(again.code, 0) << again.error;
  EXPECT_THAT(again.out, HasSubstr("Langevin's thermostat at 310 K, friction 5/ps"));
  EXPECT_EQ(contents(out.string() + ".1/trajectory.dcd"), before.at("trajectory.dcd"));
  EXPECT_EQ(run({"resume", out.string(), "--steps", "20", "--set", "run.thermostat=none"}).code, 0);
  expect_one_line(run({"resume", out.string(), "--steps", "20", "--set", "run.temperature_k=320"}), 2);

  const Ending finer = run({"resume", out.string(), "--steps", "20", "--set", "run.trajectory_every=0",
                            "run.dt_fs=0.5", "method.name=newton"});
  EXPECT_EQ(finer.code, 0) << finer.error;
  EXPECT_THAT(finer.out, AllOf(HasSubstr("method newton"), HasSubstr("steps of 0.5 fs")));

  // A thermostat's temperature goes with it where velocities were the start's.
  const fs::path kept = in("kept");
  ASSERT_EQ(run({"run", "water_cluster", "--steps", "20", "--set", "run.thermostat=langevin",
                 "run.temperature_k=310", "build.start=" + (out / "final.start.toml").string(), "--out",
                 kept.string()})
                .code,
            0);
  const Ending free = run({"resume", kept.string(), "--steps", "20", "--set", "run.thermostat=none"});
  EXPECT_EQ(free.code, 0) << free.error;
}

}  // namespace
}  // namespace taut::long_runs_tests
