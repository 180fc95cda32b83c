// The command is stopped, at every stage of every command and by each signal, or the disk refuses what it
// writes: the exit code is the README's, one line says why, and nothing that was the user's is lost.

#include <sys/resource.h>

#include "shell.hpp"

namespace taut::stops_tests {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;

int lines(const std::string& text) {
  return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

// Patience is for tests that fail.
void wait_until(const std::function<bool()>& so) {
  for (int n = 0; n < 60000 && !so(); ++n) usleep(1000);
}

const std::string kEndless = "run pendulum --steps 1000000000000 --set run.log_every=1000000000000 ";

struct Stage {
  const char* name;
  std::string words;  // OUT is the folder
  std::function<bool(const Shell&, const fs::path& out)> reached;
  const char* said;  // a regular expression for what is printed, by both streams, at and after the signal
  const char* then;  // the command that goes on; empty: there is nothing to go on from, and no folder
};

bool computing(const Shell& taut, const fs::path&) {
  return taut.has_computed(0.2);
}

bool kept(const Shell&, const fs::path& out) {
  wait_until([&] { return fs::exists(out / "checkpoint.cbor"); });
  return fs::exists(out / "checkpoint.cbor");
}

bool tried(const Shell&, const fs::path& out) {
  wait_until([&] { return lines(contents(out / "unfinished.tsv")) > 1; });
  return lines(contents(out / "unfinished.tsv")) > 1;
}

bool noted(const Shell&, const fs::path& out) {
  const auto is_noted = [&] {
    return contents(out.parent_path() / "said").find("note: quick") != std::string::npos;
  };
  wait_until(is_noted);
  return is_noted();
}

// Long enough to be stopped in, wherever that is.
const std::string kLarge = "water --set build.molecules=60000 run.minimise=true ";
const std::string kStudy = " diatomic --quick --methods newton --out OUT ";

std::vector<Stage> stages() {
  [[maybe_unused]] const char* anything = "(.|\n)*";
  const char* goes_on =
      "(.|\n)*stopped at step [0-9]+ of [0-9]+ by SIG[A-Z]+; `taut resume .*` goes on from step [0-9]+\n";
  const char* only_that =
      "stopped at step [0-9]+ of [0-9]+ by SIG[A-Z]+; `taut resume .*` goes on from step [0-9]+\n";
  const char* resume = "resume OUT --set run.steps=0";
  const char* study = "(.|\n)*\nstopped; the same command goes on from here\n";
  return {
    {"Construction", "run " + kLarge + "--out OUT", computing, "", ""},
        {"RunThatKeepsNothing", kEndless, computing,
         "(.|\n)*stopped at step [0-9]+ of [0-9]+ by SIG[A-Z]+; nothing was kept: a run with --out can be "
         "resumed\n",
         ""},
        {"Run", kEndless + "--out OUT", kept, goes_on, resume},
        {"RunQuietly", kEndless + "--quiet --out OUT", kept, only_that, resume},
        {"RunForPrograms", kEndless + "--json --out OUT", kept, only_that, resume},
        {"Checkpoint", kEndless + "run.checkpoint_every=1 --out OUT", kept, goes_on, resume},
        {"Calibrate", "calibrate " + kLarge, computing, "", ""},
        {"Chart", "chart" + kStudy + "--drift-steps 30000000", tried, study, "chart"},
        {"ChartForPrograms", "chart" + kStudy + "--drift-steps 30000000 --json", tried, study, "chart"},
        {"Stability", "stability" + kStudy + "--steps 300000000", noted, study, "stability"},
#if TAUT_WITH_OPENMM_TWIN
        {"Crosscheck", "crosscheck diatomic --steps 100000000 --methods newton --speed-seconds 0 --out OUT",
         computing, anything, ""},
#endif
  };
}

class Signals : public ::testing::TestWithParam<Stage> {
 protected:
  Arguments asked(const std::string& line) const {
    Arguments all = words(line);
    for (std::string& word : all)
      if (word == "OUT") word = out().string();
    return all;
  }
  fs::path out() const { return folder_.path() / "out"; }

  TemporaryFolder folder_;
};

void PrintTo(const Stage& stage, std::ostream* out) {
  *out << stage.words;
}

INSTANTIATE_TEST_SUITE_P(Stages, Signals, ::testing::ValuesIn(stages()),
                         [](const auto& test) { return test.param.name; });

TEST_P(Signals, StopItAsThePageSays) {
  const Stage& stage = GetParam();
  const fs::path said = folder_.path() / "said";
  Shell taut(folder_.path(), asked(stage.words), [&] {
    const int file = open(said.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) dup2(file, stream);
  });
  ASSERT_TRUE(stage.reached(taut, out())) << contents(said);
  taut.send(SIGTERM);
  EXPECT_EQ(taut.wait(), 128 + SIGTERM);
  EXPECT_THAT(contents(said), MatchesRegex(stage.said));
  if (!*stage.then) {
    EXPECT_FALSE(fs::exists(out() / "log.csv"));
    return;
  }
  const std::string kept = contents(out() / "unfinished.tsv");
  if (!kept.empty()) {
    // The same command goes on from what is there: stopped again, it has lost nothing.
    Shell again(folder_.path(), asked(stage.words), [] {});
    EXPECT_TRUE(again.has_computed(0.1));
    again.send(SIGTERM);
    EXPECT_EQ(again.wait(), 128 + SIGTERM);
    const std::string now = contents(out() / "unfinished.tsv");
    std::istringstream trials(kept.substr(0, kept.rfind('\n') + 1));
    for (std::string trial; std::getline(trials, trial);) EXPECT_THAT(now, HasSubstr(trial + "\n"));
    return;
  }
  Shell again(folder_.path(), asked(stage.then), [] {});
  EXPECT_EQ(again.wait(), 0) << again.error();
}

class Terminals : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  fs::path out_ = folder_.path() / "out";
};

TEST_F(Terminals, CtrlCStopsARun) {
  Shell taut(folder_.path(), words(kEndless + "--out " + out_.string()));
  read_from(taut.terminal(), "\n       0     0.0000");
  ASSERT_EQ(write(taut.terminal(), "\x03", 1), 1);
  EXPECT_THAT(read_from(taut.terminal()), HasSubstr("goes on from step "));
  EXPECT_EQ(taut.wait(), 130);
}

TEST_F(Terminals, ATerminalThatIsClosedStopsARun) {
  Shell taut(folder_.path(), words(kEndless + "--out " + out_.string()));
  read_from(taut.terminal(), "\n       0     0.0000");
  taut.close_terminal();
  EXPECT_EQ(taut.wait(), 129);
  Shell again(folder_.path(), {"resume", out_.string(), "--set", "run.steps=0"}, [] {});
  EXPECT_EQ(again.wait(), 0) << again.error();
}

// Ctrl-C reaches Python as well, while taut waits for it.
TEST_F(Terminals, CtrlCWhilePythonDrawsStopsAStudy) {
  const fs::path python = folder_.write("python", "#!/bin/sh\nkill -INT $$\n");
  fs::permissions(python, fs::perms::owner_all);
  const std::string study =
      "chart diatomic --quick --methods newton --repeats 1 --drift-steps 20 --out " + out_.string();
  Shell stopped(folder_.path(), words(study), [&] { setenv("TAUT_PYTHON", python.c_str(), 1); });
  EXPECT_EQ(stopped.wait(), 130);
  EXPECT_TRUE(fs::exists(out_ / "unfinished.tsv"));
  Shell other(folder_.path(), words(study + " --dt-fs 2"), [] {});
  EXPECT_EQ(other.wait(), 2);
  EXPECT_THAT(other.error(), HasSubstr("was stopped, of another command or scene"));
  Shell again(folder_.path(), words(study), [] {});
  EXPECT_EQ(again.wait(), 0) << again.error();
}

struct Filled {
  const char* words;  // OUT is the folder, FILE a file
  rlim_t bytes;       // no file may be larger
  const char* file;   // that is refused
};

void PrintTo(const Filled& filled, std::ostream* out) {
  *out << filled.words;
}

class FullDisks : public ::testing::TestWithParam<Filled> {};

// The size of files is limited, as the room on a disk is.
TEST_P(FullDisks, AreOneLineAndLoseNothing) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  const auto asked = [&](const std::string& line) {
    Arguments all = words(line);
    for (std::string& word : all) {
      if (word == "OUT") word = out.string();
      if (word == "FILE") word = (folder.path() / "file").string();
    }
    return all;
  };
  Pipe pipe;
  Shell full(folder.path(), asked(GetParam().words), [&] {
    dup2(pipe.ends[1], STDERR_FILENO);
    dup2(open("/dev/null", O_WRONLY), STDOUT_FILENO);
    const rlimit limit{GetParam().bytes, GetParam().bytes};
    setrlimit(RLIMIT_FSIZE, &limit);
  });
  Pipe::close_end(pipe.ends[1]);
  const std::string error = read_from(pipe.ends[0]);
  EXPECT_EQ(full.wait(), 3) << error;
  EXPECT_EQ(lines(error), 1) << error;
  EXPECT_THAT(error, HasSubstr(GetParam().file));
  EXPECT_THAT(error, Not(HasSubstr(".part")));
  EXPECT_THAT(error, HasSubstr("File too large"));
  for (const auto& entry : fs::recursive_directory_iterator(folder.path()))
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
  Shell again(folder.path(), asked(GetParam().words), [] {});
  EXPECT_EQ(again.wait(), 0) << again.error();
}

const char* const kRun =
    "run freely_jointed --steps 400 --set build.chains=2 run.trajectory_every=1 run.trajectory=both "
    "--continue --out OUT";
const char* const kDcd =
    "run freely_jointed --steps 400 --set build.chains=2 run.trajectory_every=1 --continue --out OUT";

INSTANTIATE_TEST_SUITE_P(
    Files, FullDisks,
    ::testing::Values(Filled{kRun, 100, "start.pdb"}, Filled{kRun, 100000, "trajectory.h5md"},
                      Filled{kDcd, 100000, "trajectory.dcd"},
                      Filled{"run diatomic --steps 1000 --set run.log_every=1 --continue --out OUT", 30000,
                             "log.csv"},
                      Filled{"run water --steps 4 --continue --out OUT", 20000, "checkpoint.cbor"},
                      Filled{"calibrate diatomic --sweeps 1 --json FILE", 100, "file"},
                      Filled{"chart diatomic --quick --methods newton --repeats 1 --drift-steps 20 --out OUT",
                             400, "unfinished.tsv"},
                      Filled{"stability diatomic --quick --methods newton --steps 20 --alpha-h 0.1 0.3 "
                             "--beta-h 1 1.4 --out OUT",
                             2000, "unfinished.tsv"},
                      Filled{"crosscheck water --steps 2 --methods newton --speed-seconds 0 --export FILE",
                             20000, "file.s"}),
    [](const auto& test) { return "case" + std::to_string(test.index); });

}  // namespace
}  // namespace taut::stops_tests
