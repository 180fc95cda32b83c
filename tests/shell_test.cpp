// The command between a shell's streams, every way of printing at every border: a pipe, a closed pipe, a full
// disk, a terminal; --quiet, --json; options before and after the scene.

#include "shell.hpp"

#include <nlohmann/json.hpp>

namespace taut::shell_tests {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

// Never ends by itself, and says no more than its first row.
const std::string kEndless = "run pendulum --steps 1000000000000 --set run.log_every=1000000000000 ";

struct Words {
  const char* name;
  const char* words;  // OUT is a folder of its own, RUN one that holds a run
  bool tables;        // it has --json
};

const Words kCommands[] = {
    {"run", "run diatomic --steps 5", true},
    {"run_in_folder", "run diatomic --steps 5 --out OUT", true},
    {"resume", "resume RUN --steps 5", true},
    {"resume_done", "resume RUN", true},
    {"measure", "measure RUN", true},
    {"plot", "plot RUN --out OUT", true},
    {"scan", "scan diatomic --steps 20 --vary run.dt_fs=1,2 --set run.log_every=5 --out OUT", true},
    {"calibrate", "calibrate diatomic --sweeps 1", false},
    {"calibrate_json", "calibrate diatomic --sweeps 1 --json -", false},
    {"chart", "chart diatomic --quick --methods newton --repeats 1 --drift-steps 20 --out OUT", true},
    {"stability",
     "stability diatomic --quick --methods newton --steps 20 --alpha-h 0.1 0.3 --beta-h 1 1.4 --out OUT",
     true},
#if TAUT_WITH_OPENMM_TWIN
    {"crosscheck", "crosscheck diatomic --steps 5 --methods newton --speed-seconds 0 --out OUT", true},
#endif
    {"methods", "methods", true},
    {"scenes", "scenes", true},
    {"info", "info diatomic", true},
    {"help", "help run", true},
    {"usage", "run --help", false},
    {"version", "--version", false},
    {"generate", "generate bash", false},
};

void PrintTo(const Words& command, std::ostream* out) {
  *out << command.words;
}

class Borders : public ::testing::TestWithParam<std::tuple<Words, bool>> {
 protected:
  bool with_json() const { return std::get<1>(GetParam()); }
  bool prints_json() const {
    return with_json() || std::get<0>(GetParam()).name == std::string("calibrate_json");
  }
  fs::path out() const { return folder_.path() / "out"; }

  // The words of the case, and more; a run is there if they ask for one.
  Arguments asked(const std::string& more = "") const {
    const auto& [command, with_json] = GetParam();
    Arguments all = words(command.words + std::string(with_json ? " --json " : " ") + more);
    for (std::string& word : all) {
      if (word == "OUT") word = out().string();
      if (word != "RUN") continue;
      word = (folder_.path() / "run").string();
      Shell run(
          folder_.path(),
          words("run freely_jointed --steps 40 --quiet --set build.chains=2 run.trajectory_every=1 --out " +
                word),
          [] {});
      EXPECT_EQ(run.wait(), 0) << run.error();
    }
    return all;
  }

  TemporaryFolder folder_;
};

std::vector<std::tuple<Words, bool>> cases() {
  std::vector<std::tuple<Words, bool>> all;
  for (const Words& command : kCommands) {
    all.emplace_back(command, false);
    if (command.tables) all.emplace_back(command, true);
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Commands, Borders, ::testing::ValuesIn(cases()), [](const auto& test) {
  return std::get<0>(test.param).name + std::string(std::get<1>(test.param) ? "_json_alone" : "");
});

TEST_P(Borders, APipeHasItAll) {
  Pipe pipe;
  Shell taut(folder_.path(), asked(), [&] { dup2(pipe.ends[1], STDOUT_FILENO); });
  Pipe::close_end(pipe.ends[1]);
  const std::string text = read_from(pipe.ends[0]);
  EXPECT_EQ(taut.wait(), 0);
  EXPECT_EQ(taut.error(), "");
  EXPECT_EQ(json::accept(text), prints_json()) << text;
}

TEST_P(Borders, AClosedPipeStopsItInSilence) {
  Pipe pipe;
  Pipe::close_end(pipe.ends[0]);
  Shell taut(folder_.path(), asked(), [&] { dup2(pipe.ends[1], STDOUT_FILENO); });
  EXPECT_EQ(taut.wait(), 128 + SIGPIPE);
  EXPECT_EQ(taut.error(), "");
}

TEST_P(Borders, AFullDiskBehindStandardOutputIsOneLine) {
  Shell taut(folder_.path(), asked(), [] { dup2(open("/dev/full", O_WRONLY), STDOUT_FILENO); });
  EXPECT_EQ(taut.wait(), 3);
  EXPECT_EQ(taut.error(), "taut: standard output: cannot write: No space left on device\n");
}

// On a terminal a line of progress comes and goes; not under --quiet, which leaves JSON alone.
TEST_P(Borders, QuietlyATerminalHasJsonOrNothing) {
  const std::string name = std::get<0>(GetParam()).name;
  if (name == "usage" || name == "version") return;  // they print what was asked for
  Shell taut(folder_.path(), asked("--quiet"));
  const std::string text = read_from(taut.terminal());
  EXPECT_EQ(taut.wait(), 0) << text;
  if (prints_json())
    EXPECT_TRUE(json::accept(text)) << text;
  else
    EXPECT_EQ(text, "");
}

class Streams : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
};

// `tee`, nohup and batch systems see a row when it is there, and a kill does not lose it.
TEST_F(Streams, APipeHasARowAsSoonAsItIsKnown) {
  Pipe pipe;
  Shell taut(folder_.path(), words(kEndless), [&] { dup2(pipe.ends[1], STDOUT_FILENO); });
  EXPECT_THAT(read_from(pipe.ends[0], "\n       0     0.0000"), HasSubstr("\n       0     0.0000"));
}

// What failed is told by the exit code where nobody reads the reason.
TEST_F(Streams, AClosedPipeForErrorsLeavesTheExitCode) {
  Pipe pipe;
  Pipe::close_end(pipe.ends[0]);
  const auto code = [&](const std::string& line) {
    return Shell(folder_.path(), words(line), [&] { dup2(pipe.ends[1], STDERR_FILENO); }).wait();
  };
  EXPECT_EQ(code("run nowhere"), 2);
  EXPECT_EQ(code("run pendulum --out /proc/taut --quiet"), 3);
  EXPECT_EQ(code("run water --dt-fs 20 --steps 1000 --quiet"), 1);
}

TEST_F(Streams, ProgressIsForTerminalsThatWantIt) {
  const auto on_terminal = [&](const std::string& line) {
    Shell taut(folder_.path(), words(line));
    return read_from(taut.terminal());
  };
  const std::string progress = "\x1b[K", run = "run diatomic --steps 5";
  EXPECT_THAT(on_terminal(run), HasSubstr(progress));
  EXPECT_THAT(on_terminal(run + " --json"), HasSubstr(progress));
  EXPECT_EQ(on_terminal(run + " --quiet"), "");
}

// A list takes the words that can be in it, so the scene may stand before it, behind it or amid it.
TEST_F(Streams, OptionsMayStandBeforeTheScene) {
  const auto said = [&](const std::string& line, int code) {
    Pipe pipe;
    Shell taut(folder_.path(), words(line), [&] {
      dup2(pipe.ends[1], STDOUT_FILENO);
      dup2(pipe.ends[1], STDERR_FILENO);
    });
    Pipe::close_end(pipe.ends[1]);
    const std::string text = read_from(pipe.ends[0]);
    EXPECT_EQ(taut.wait(), code) << line << "\n" << text;
    return text;
  };
  for (const char* line : {"info --json diatomic --set run.log_every=7 run.steps=9",
                           "info --json --set run.log_every=7 run.steps=9 diatomic",
                           "info --json --set=run.log_every=7 run.steps=9 diatomic",
                           "info --json --set run.log_every=7 run.steps=9 -- diatomic"}) {
    const json keys = json::parse(said(std::string("--quiet ") + line, 0))["keys"];
    int found = 0;
    for (const json& key : keys)
      found += (key["key"] == "run.log_every" && key["value"] == "7") ||
               (key["key"] == "run.steps" && key["value"] == "9");
    EXPECT_EQ(found, 2) << line << keys;
  }
  for (const char* line :
       {"chart diatomic --methods newton rattle", "chart --methods newton diatomic rattle"})
    EXPECT_THAT(said(line + std::string(" --quick --repeats 1 --drift-steps 20 --overwrite --out ") +
                         (folder_.path() / "chart").string(),
                     0),
                HasSubstr("of 2 methods"))
        << line;
  const std::string run = (folder_.path() / "run").string();
  said("run --set run.trajectory_every=1 build.chains=2 freely_jointed --steps 40 --out " + run, 0);
  said("resume --set run.log_every=5 " + run + " --steps 5", 0);
  said("measure --atoms BEAD BEAD " + run, 0);

  EXPECT_EQ(said("run --set diatomic", 2), "taut: --set diatomic: expected key=value, such as run.dt_fs=2\n");
  EXPECT_EQ(said("run --set run.steps=1 diatomic water", 2),
            "taut: run: there is no place for \"water\": the scene is \"diatomic\"\n");
}

// Whoever adds a command says here how it is tried.
TEST_F(Streams, EveryCommandIsTried) {
  Pipe pipe;
  Shell taut(folder_.path(), {"--help"}, [&] { dup2(pipe.ends[1], STDOUT_FILENO); });
  Pipe::close_end(pipe.ends[1]);
  std::istringstream help(read_from(pipe.ends[0]));
  std::set<std::string> tried{"crosscheck"}, there;  // which may be built without
  for (const Words& command : kCommands) tried.insert(words(command.words)[0]);
  for (std::string line; std::getline(help, line) && line != "Subcommands:" && line != "SUBCOMMANDS:";)
    continue;  // in capitals since CLI11 2.5
  for (std::string line; std::getline(help, line) && !line.empty();)
    if (line[2] != ' ') there.insert(words(line)[0]);  // but for a meaning's second line
  EXPECT_THAT(tried, ::testing::IsSupersetOf(there));
  EXPECT_GT(there.size(), 8u);
}

}  // namespace
}  // namespace taut::shell_tests
