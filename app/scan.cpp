#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/errors.hpp"
#include "base/threads.hpp"
#include "base/usable_cores.hpp"
#include "base/words.hpp"
#include "commands.hpp"
#include "files/atomic_file.hpp"
#include "files/folder.hpp"
#include "files/text_file.hpp"
#include "measured_groups.hpp"
#include "printing.hpp"
#include "progress.hpp"
#include "scene_argument.hpp"
#include "stop_request.hpp"
#include "study.hpp"

extern char** environ;

namespace taut {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestWord = 128 * 1024 - 1;  // of a command line, as execve(2) of Linux has it
constexpr const char* kCommands = "commands.txt";  // the command lines of a scan's runs, by which it is known

struct ScanArguments : SceneArgument {
  std::vector<std::string> vary;
  int seeds = 1;
  std::optional<int> jobs;
  fs::path out;
  PictureOptions pictures;
  bool pmf = false;
};

// One run of a scan: its folder, and the arguments of `taut run`.
struct ScanRun {
  fs::path folder;
  std::string label;
  std::vector<std::string> words;
};

// KEY=a,b,c as its key and values; commas within brackets belong to a value.
std::pair<std::string, std::vector<std::string>> key_and_values(const std::string& text) {
  const auto equals = text.find('=');
  std::vector<std::string> values(1);
  int depth = 0;
  for (const char c : equals == text.npos ? "" : text.substr(equals + 1)) {
    depth += (c == '[') - (c == ']');
    if (c == ',' && depth == 0)
      values.emplace_back();
    else
      values.back() += c;
  }
  if (equals == text.npos || equals == 0 || std::ranges::count(values, "") > 0)
    throw InputError(
        fmt::format("--vary {}: expected KEY=VALUE,VALUE,... as in run.temperature_k=280,300", text));
  return {text.substr(0, equals), values};
}

// Every combination of the values, the last key changing fastest.
std::vector<ScanPoint> points_of(const ScanArguments& arguments) {
  std::vector<ScanPoint> points(1);
  for (const std::string& text : arguments.vary) {
    const auto [key, values] = key_and_values(text);
    if (key == "run.seed") throw InputError("--vary run.seed: seeds are asked for by --seeds N");
    std::vector<ScanPoint> more;
    for (const ScanPoint& point : points)
      for (const std::string& value : values) {
        if (std::ranges::count(point.values, key, [](const auto& v) { return v.first; }) > 0)
          throw InputError(fmt::format("--vary {}: the key is varied twice", key));
        more.push_back(point);
        more.back().values.emplace_back(key, value);
      }
    points = std::move(more);
  }
  int number = 0;
  for (ScanPoint& point : points) {
    // Under the same random numbers the errors of neighbouring lengths would be alike, and add up in the integral.
    if (arguments.pmf) point.first_seed = number + 1;
    for (int seed = 1; seed <= arguments.seeds; ++seed)
      point.runs.push_back(arguments.out / fmt::format("{:03}", ++number));
  }
  return points;
}

// Gives the log the tension of the bond whose length is varied. Throws InputError where it has no potential of mean force.
void ask_for_mean_force(ScanArguments& arguments, const std::vector<ScanPoint>& points) {
  std::vector<Scene> scenes;
  for (const ScanPoint& point : points) {
    ScanArguments one = arguments;
    for (const auto& [key, value] : point.values) one.settings.push_back(key + "=" + value);
    scenes.push_back(one.read());
  }
  std::vector<const Scene*> along;
  for (const Scene& scene : scenes) along.push_back(&scene);
  const std::vector<std::array<int, 2>> varied = bonds_of_several_lengths(along);
  if (varied.empty())
    throw InputError(
        "--pmf: no rigid bond has several lengths; expected --vary of one, as in "
        "molecule.ions.bonds.0.2=0.3,0.35,0.4");
  if (scenes.front().run.tension_of.empty()) {
    std::string pairs;
    for (const auto& [i, j] : varied) pairs += fmt::format("{}[{}, {}]", pairs.empty() ? "" : ", ", i, j);
    arguments.settings.push_back(fmt::format("run.tension_of=[{}]", pairs));
    if (arguments.settings.back().size() > kLongestWord)
      throw InputError(
          fmt::format("--pmf: {} bonds change their length, more than a command line can name; "
                      "place fewer molecules (place.0.count), or name the bonds in the scene's own "
                      "run.tension_of",
                      varied.size()));
    for (Scene& scene : scenes) scene.run.tension_of = varied;
  }
  std::string flaw = flaw_of_lengths(along);
  for (const Scene* scene : along)
    if (flaw.empty()) flaw = flaw_of_mean_force(*scene);
  if (!flaw.empty()) throw InputError("--pmf: " + flaw);
}

bool gives_seeds(const ScanArguments& arguments) {  // else the single run of a point has the scene's own
  return arguments.pmf || arguments.seeds > 1;
}

void refuse_seed(const ScanArguments& arguments) {
  if (gives_seeds(arguments) && key_values(arguments.settings).contains("run.seed"))
    throw InputError(
        fmt::format("--set run.seed: {} gives each run a seed of its own, 1, 2, ...; leave it out",
                    arguments.pmf ? "--pmf" : "--seeds"));
}

void tell_replaced_seed(const Scene& scene, const std::vector<ScanPoint>& points) {
  const RunSettings usual;
  if (scene.run.seed != usual.seed)
    say("the scene's run.seed = {} is replaced: the runs have seeds from 1 to {}\n", scene.run.seed,
        points.back().first_seed + static_cast<int>(points.back().runs.size()) - 1);
}

// The runs of all points. Reads each point's scene once, so that a wrong value is refused before anything runs.
std::vector<ScanRun> runs_of(const ScanArguments& arguments, const std::vector<ScanPoint>& points) {
  std::vector<ScanRun> runs;
  for (const ScanPoint& point : points) {
    ScanArguments one = arguments;
    for (const auto& [key, value] : point.values) one.settings.push_back(key + "=" + value);
    const Scene scene = one.read();
    if (runs.empty() && gives_seeds(arguments)) tell_replaced_seed(scene, points);
    for (std::size_t k = 0; k < point.runs.size(); ++k) {
      const int seed = point.first_seed + static_cast<int>(k);
      ScanRun run{.folder = point.runs[k],
                  .label = fmt::format("{}, seed {}", point.label(), seed),
                  .words = {"run"}};
      if (!one.scene.empty()) run.words.push_back(one.scene);
      if (!one.openmm.empty()) run.words.insert(run.words.end(), {"--openmm", one.openmm[0], one.openmm[1]});
      for (const std::string& setting : one.overrides())
        run.words.insert(run.words.end(), {"--set", setting});
      if (gives_seeds(arguments))
        run.words.insert(run.words.end(), {"--set", fmt::format("run.seed={}", seed)});
      run.words.insert(run.words.end(), {"--out", run.folder.string(), "--continue", "--quiet", "--threads",
                                         fmt::format("{}", available_threads())});
      runs.push_back(std::move(run));
    }
  }
  return runs;
}

// Starts `taut run` with its output in FOLDER.log. Throws OutsideError.
pid_t start(const ScanRun& run) {
  std::vector<std::string> words = {"taut"};
  words.insert(words.end(), run.words.begin(), run.words.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const std::string log = run.folder.string() + ".log";
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t child = 0;
  const int error = posix_spawn(&child, "/proc/self/exe", &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw OutsideError(fmt::format("cannot start `taut run`: {}", std::strerror(error)));
  return child;
}

// Runs what is not finished, `jobs` at once. Returns the labels of runs that failed. Throws Stopped when a signal
// asks to stop; the runs then have written their checkpoints.
std::vector<std::string> take_runs(const std::vector<ScanRun>& runs, int jobs) {
  const StopRequest request;
  std::vector<std::string> failed;
  std::map<pid_t, const ScanRun*> running;
  const long all = std::ssize(runs);
  long done = 0, taken = 0;
  std::vector<const ScanRun*> left;
  for (const ScanRun& run : runs)
    if (is_finished(run.folder))
      ++done;
    else
      left.push_back(&run);
  if (done > 0) say("going on: {} of {} runs are finished\n", done, all);
  Progress progress(std::ssize(left));
  const auto begin = std::chrono::steady_clock::now();
  for (auto next = left.begin(); next != left.end() || !running.empty();) {
    while (request.signal() == 0 && next != left.end() && std::ssize(running) < jobs) {
      running.emplace(start(**next), *next);
      ++next;
    }
    if (request.signal() != 0) {
      for (const auto& [child, run] : running) kill(child, SIGTERM);
      for (const auto& [child, run] : running) waitpid(child, nullptr, 0);
      say_always(fmt::format("stopped: {} of {} runs are finished; the same command goes on\n", done, all));
      throw Stopped{128 + request.signal()};
    }
    int status = 0;
    const pid_t child = waitpid(-1, &status, WNOHANG);
    const auto at = running.find(child);
    if (child <= 0 || at == running.end()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      continue;
    }
    const ScanRun& run = *at->second;
    const bool good = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    progress.clear();
    ++done, ++taken;
    const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const double left_s = spent / static_cast<double>(taken) * static_cast<double>(all - done);
    say("{} of {}: {}: {}; {:.0f} s so far{}\n", done, all, run.label,
        good ? "done" : fmt::format("failed, see {}.log", run.folder.string()), spent,
        done < all ? fmt::format(", some {:.0f} s left", left_s) : "");
    progress.show_step(taken);
    if (!good) failed.push_back(run.label);
    running.erase(at);
  }
  progress.clear();
  return failed;
}

// Throws InputError if the folder holds another scan, or files under the names that a scan would write and that no
// scan's commands.txt accounts for. line: what commands.txt of this scan says.
void refuse_foreign_files(const fs::path& folder, const std::vector<ScanRun>& runs, const std::string& line) {
  const fs::path commands = folder / kCommands;
  if (fs::exists(commands)) {
    if (contents_of(commands) == line) return;
    throw InputError(
        fmt::format("{}: holds another scan; take another folder, or delete it", folder.string()));
  }
  std::vector<std::string> names = {kScanTable, kZeroSteps};
  for (const char* picture : {"scan", "each_run", kMeanForce})
    std::ranges::copy(files_of_picture(picture), std::back_inserter(names));
  for (const ScanRun& run : runs)
    for (const char* kind : {"", ".log"}) names.push_back(run.folder.filename().string() + kind);
  if (const auto there = list_present(folder, names); !there.empty())
    throw InputError(
        fmt::format("{}: {} is there already, and no scan's {} is; take another folder, or move it",
                    folder.string(), there.front(), kCommands));
}

void scan(ScanArguments arguments) {
  if (arguments.vary.empty() && arguments.seeds < 2)
    throw InputError("nothing to scan: expected --vary KEY=VALUE,VALUE,... or --seeds of 2 or more");
  refuse_seed(arguments);
  const std::vector<ScanPoint> points = points_of(arguments);
  if (arguments.pmf) ask_for_mean_force(arguments, points);
  const std::vector<ScanRun> runs = runs_of(arguments, points);
  // A scan is known by its runs' command lines, so that another one does not go on in its folder.
  std::string line = "taut scan";
  for (const ScanRun& run : runs) {
    for (std::size_t w = 0; w + 2 < run.words.size(); ++w) line += " " + quoted_for_shell(run.words[w]);
    line += "\n";
  }
  refuse_foreign_files(arguments.out, runs, line);
  const FolderLock lock(arguments.out);
  write_file(arguments.out / kCommands, line);
  write_file(arguments.out / kScanTable, scan_table(points));
  const int jobs = arguments.jobs.value_or(std::max(1, usable_cores() / available_threads()));
  say("{} of {}, {} at once\n", counted(std::ssize(runs), "run"), counted(std::ssize(points), "setting"),
      jobs);
  const std::vector<std::string> failed = take_runs(runs, jobs);
  if (failed.size() == runs.size())
    throw InputError(fmt::format("every run of the scan failed; the first says: {}",
                                 contents_of(runs[0].folder.string() + ".log")));
  Notes notes;
  const MeasureSettings settings{.atoms = {}, .from = {}, .last = {}, .automatic = true, .viscosity = {}};
  const MeasuredGroups all =
      with_notes(notes, [&] { return MeasuredGroups{measure_scan(arguments.out, settings, notes)}; });
  all.print(notes);
  if (json_alone()) write_json(all.json());
  StudyFiles files(arguments.out, arguments.pictures);
  all.draw(files);
  files.print_written();
  if (!failed.empty())
    throw SimulationFailure(
        fmt::format("{} of the scan, the first: {}", counted(std::ssize(failed), "run"), failed[0]));
}

}  // namespace

void add_scan(Commands& commands) {
  auto arguments = std::make_shared<ScanArguments>();
  const Subcommand command =
      commands.add("scan", "run a scene over values of its keys and over seeds, and measure",
                   [arguments] { scan(*arguments); });
  arguments->offer(command);
  command
      .option("--vary", arguments->vary,
              "a key and its values: run.temperature_k=280,300,320; of several keys every combination")
      .key_values();
  command.flag(
      "--pmf", arguments->pmf,
      "over the length of a rigid bond: the potential of mean force along it, from its mean tension");
  command.option("--seeds", arguments->seeds, "runs of each setting, with run.seed 1, 2, ...").at_least(1);
  command.option("--jobs", arguments->jobs, "runs at once (if not said: cores over --threads)").at_least(1);
  command.option("--out", arguments->out, "folder of the runs' folders, tables and pictures").required();
  arguments->pictures.offer(command);
  command.json("the means of each setting and the figures of each run, as JSON");
}

}  // namespace taut
