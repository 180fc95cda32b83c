// `taut run` and `taut resume`: open a run, take its steps, print what it does.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "base/listen.hpp"
#include "command_line.hpp"
#include "commands.hpp"
#include "files/text_file.hpp"
#include "measures/measured_frames.hpp"
#include "pictures.hpp"
#include "printing.hpp"
#include "progress.hpp"
#include "run_picture.hpp"
#include "run_tables.hpp"
#include "scene_argument.hpp"
#include "simulation/open_run.hpp"
#include "simulation/recorded_run.hpp"
#include "stop_request.hpp"
#include "systems/molecules/whole_molecules.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

// ---- What a run prints while it takes steps

std::string resume_command(const fs::path& folder) {
  return "taut resume " + quoted_for_shell(folder.string());
}

std::string how_to_resume(const RunFolder& folder, const Simulation& simulation) {
  const std::vector<std::string> outgrown = folder.outgrown(simulation);
  return fmt::format("`{}{}` goes on from step {}{}", resume_command(folder.path()),
                     outgrown.empty() ? "" : " --yes", *folder.kept_step(),
                     outgrown.empty()
                         ? ""
                         : fmt::format(", for which {} {} cut back to there", fmt::join(outgrown, " and "),
                                       outgrown.size() == 1 ? "is" : "are"));
}

const char* name_of(int signal) {
  switch (signal) {
    case SIGINT:
      return "SIGINT";
    case SIGHUP:
      return "SIGHUP";
    case SIGPIPE:
      return "SIGPIPE";
    default:
      return "SIGTERM";
  }
}

// Prints for a run. Once a run writes to a folder, standard output that does not take a text does not stop it: it
// ends with an error. A pipe whose reader is gone stops it as a signal would.
class RunPrinter {
 public:
  RunPrinter(const StopRequest& request, const RunFolder* folder) : request_(request), folder_(folder) {}

  void print(const auto& print_text) {
    if (!folder_ && !request_.signal()) return print_text();
    try {
      print_text();
    } catch (const Stopped&) {
      request_.stop_for_closed_pipe();
    } catch (const OutsideError& e) {
      refused_ = e;
    }
  }
  void throw_if_refused() const {
    if (refused_) throw OutsideError(*refused_);
  }

 private:
  const StopRequest& request_;
  const RunFolder* folder_;
  std::optional<OutsideError> refused_;
};

// Adds to a failure where its state is kept and how to go on.
[[noreturn]] void throw_explained(const ExplainedFailure& failure, const Simulation& simulation,
                                  const RunFolder* folder) {
  if (!failure.unwritten.empty()) complain(failure.unwritten);
  std::string kept;
  if (folder && failure.unwritten.empty())
    kept = fmt::format("\n  kept: {0}/last_good.start.toml, the state one step before, and {0}/failure.json",
                       folder->path().string());
  if (folder && folder->kept_step()) kept += fmt::format("\n  {}", how_to_resume(*folder, simulation));
  throw SimulationFailure(failure.what() + kept);
}

void print_stop(const Simulation& simulation, const RunFolder* folder, int signal) {
  say("\n");
  say_always(fmt::format(
      "stopped at step {} of {} by {}; {}\n", simulation.step(), simulation.scene().run.steps,
      name_of(signal),
      folder ? how_to_resume(*folder, simulation) : "nothing was kept: a run with --out can be resumed"));
}

constexpr double kLongRun = 60;  // [s], from which the table of timings is printed unasked

// What to print at a run's end.
struct Ending {
  const MeasuredFrames* measured = nullptr;
  bool timings = false;
  bool took_steps = true;
};

void print_end(const Simulation& simulation, const Summary& summary, const RunFolder* folder,
               const Ending& ending) {
  const MeasuredFrames* measured = ending.measured;
  if (json_alone()) {
    auto all = summary_json(simulation, summary);
    if (measured) all["measured"] = measured->json();
    write_out(all.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  }
  print_summary(simulation, summary, ending.took_steps);
  if (ending.timings || summary.timings.seconds() >= kLongRun) print_timings(summary.timings);
  if (measured) say_text(measured->in_words());
  if (!json_alone())
    for (const auto& doubt : summary.doubts) say_always(fmt::format("in doubt: {}\n", doubt));
  if (!folder) return;
  std::vector<std::string> files = run_files(folder->path());
  for (std::string& file : files) file = (folder->path() / file).string();
  say("wrote {}\n", fmt::join(files, ", "));
}

// Takes the steps that are left, prints and writes. Throws SimulationFailure that explains the failure, and Stopped
// when a signal asked to stop.
void complete_run(OpenRun& run, bool timings, MeasuredFrames* measured = nullptr) {
  Simulation& simulation = *run.simulation;
  if (timings) simulation.measure_parts();
  RunFolder* folder = run.folder ? &*run.folder : nullptr;
  const StopRequest request;
  RunPrinter printer(request, folder);
  const long first = simulation.step(), steps = simulation.scene().run.steps;
  Progress progress(steps - first);
  progress.write_rows("steps");
  const auto on_record = [&](const Record& r) {
    progress.clear();
    if (measured && r.step % simulation.scene().run.log_every == 0)
      measured->add_frame(r.t, simulation.state().x, simulation.state().box);
    printer.print([&] { print_row(r); });
  };
  const auto on_step = [&](long step) {
    printer.print([&] { progress.show_step(step - first); });
    return request.signal() == 0;
  };
  Summary summary;
  try {
    if (folder) folder->begin(simulation);
    printer.print([&] {
      if (folder && !folder->note().empty()) say("{}\n", folder->note());
      print_header(simulation);
    });
    summary = take_steps(simulation, folder, {on_record, on_step});
    progress.clear();
  } catch (const ExplainedFailure& failure) {
    progress.clear();
    throw_explained(failure, simulation, folder);
  } catch (const OutsideError& e) {
    progress.clear();
    if (!folder || !folder->kept_step()) throw;
    throw OutsideError(fmt::format("{}; that mended, {}", e.what(), how_to_resume(*folder, simulation)));
  }
  if (simulation.step() < steps) {
    const int signal = request.signal();
    printer.print([&] { print_stop(simulation, folder, signal); });
    throw Stopped{128 + signal};
  }
  print_end(simulation, summary, folder, {measured, timings, simulation.step() > first});
  printer.throw_if_refused();
}

void print_finished(const OpenRun& run, const fs::path& folder) {
  if (json_alone()) return write_out(contents_of(folder / "summary.json"));
  say("{}: all {} steps are taken; `{} --steps N` takes N more\n", folder.string(), run.simulation->step(),
      resume_command(folder));
}

// ---- What a run was told

RunOptionNames option_names(const fs::path& folder) {
  return {.folder = "--out DIR",
          .go_on = "--continue",
          .overwrite = "--overwrite",
          .resume = fmt::format("`{}`", resume_command(folder)),
          .accept = fmt::format("`{} --yes`", resume_command(folder))};
}

bool ask_person(const std::string& what) {
  if (!isatty(STDIN_FILENO) || !isatty(STDERR_FILENO)) return false;
  fmt::print(stderr, "{} Go on? [y/N] ", what);
  std::string answer;
  std::getline(std::cin, answer);
  return answer == "y" || answer == "yes";
}

struct RunArguments : SceneArgument {
  std::optional<fs::path> out;
  bool go_on = false, overwrite = false, measure = false, timings = false, plot = false;
  PictureOptions pictures;

  RunArguments() { as_run = true; }

  RunRequest request() const {
    RunRequest request{.mode = go_on       ? RunMode::kContinue
                               : overwrite ? RunMode::kOverwrite
                                           : RunMode::kNew,
                       .folder = out.value_or(""),
                       .may_take_all_cores = true,
                       .names = option_names(out.value_or("")),
                       .leave_finished = true};
    request.scene = read(nullptr, {}, &request);
    if (!out)
      request.source = {};
    else if (openmm.empty())
      request.source = source_of(*request.scene, overrides());
    for (const auto& [key, value] : key_values(overrides())) request.usual.erase(key);
    return request;
  }
};

// Opens a run that goes on. Its scene's files may be read from a temporary folder: from there on a signal ends it where it
// listens, and the folder goes. Throws Stopped.
OpenRun open_begun_run(RunRequest request) {
  std::optional<StopRequest> asked;
  const ListenScope stopped([&] {
    if (!asked) asked.emplace();
    if (asked->signal() != 0) throw Stopped{128 + asked->signal()};
  });
  OpenRun run = open_run(std::move(request));
  hear();
  return run;
}

// A net of many rings in one cluster fills as it is eliminated, before the first step: in work and memory.
void say_if_start_is_slow(const System& sys) {
  constexpr int kManyRings = 2000;  // seconds, and gigabytes
  std::vector<BondedPair> pairs;
  for (const RigidBond& bond : sys.bonds) pairs.push_back({bond.i, bond.j});
  const std::vector<int> cluster = molecules(sys.atoms(), pairs);
  std::vector<int> rings(cluster.size(), 1);  // of each cluster: bonds − atoms + 1
  for (const int of : cluster) --rings[of];
  for (const RigidBond& bond : sys.bonds) ++rings[cluster[bond.i]];
  const int most = rings.empty() ? 0 : std::ranges::max(rings);
  if (most < kManyRings) return;
  say("  one cluster of rigid bonds closes {} rings: to find how to solve for all at once may take minutes "
      "and gigabytes\n",
      most);
}

void run_scene(const RunArguments& arguments) {
  if (arguments.plot && !arguments.out)
    throw InputError("--plot: there is no folder to draw in; give --out DIR");
  RunRequest request = arguments.request();
  say_if_start_is_slow(request.scene->system);
  OpenRun run = arguments.go_on ? open_begun_run(std::move(request)) : open_run(std::move(request));
  if (run.finished) return print_finished(run, *arguments.out);
  std::optional<MeasuredFrames> measured;
  if (arguments.measure) measured.emplace(run.simulation->scene(), std::vector<std::string>{});
  complete_run(run, arguments.timings, measured ? &*measured : nullptr);
  if (!arguments.plot) return;
  plot_runs({.runs = {*arguments.out},
             .out = *arguments.out / "plot",
             .command = "taut plot " + quoted_for_shell(arguments.out->string()),
             .pictures = arguments.pictures,
             .overwrite = true});
}

struct ResumeArguments {
  fs::path folder;
  std::optional<long> steps;
  std::vector<std::string> settings;
  bool yes = false, timings = false;

  RunRequest request() const {
    RunRequest request{.mode = RunMode::kResume,
                       .folder = folder,
                       .names = option_names(folder),
                       .changes = key_values(collect_overrides({}, settings)),
                       .more_steps = steps,
                       .accept = yes,
                       .ask = ask_person,
                       .leave_finished = true};
    if (steps && request.changes.contains("run.steps"))
      throw InputError("--steps and --set run.steps: one of them, the steps to come or all in all");
    return request;
  }
};

void resume_run(const ResumeArguments& arguments) {
  OpenRun run = open_begun_run(arguments.request());
  if (run.finished) return print_finished(run, arguments.folder);
  complete_run(run, arguments.timings);
}

}  // namespace

constexpr const char* kTimings =
    "at the end tell where the time went, part by part, as runs of more than a minute do";

void add_run(Commands& commands) {
  auto arguments = std::make_shared<RunArguments>();
  const Subcommand command = commands.add("run", "run a scene, or a system prepared for OpenMM",
                                          [arguments] { run_scene(*arguments); });
  arguments->offer(command);
  command.option("--out", arguments->out,
                 "folder for log.csv, checkpoint.cbor, summary.json and the final state");
  const Argument go_on = command.flag(
      "--continue", arguments->go_on,
      "go on with the run of the same input in --out, or start it where there is none: for queues");
  command
      .flag("--overwrite", arguments->overwrite, "move what run is in --out to OUT.1, OUT.2, ..., and start")
      .excludes(go_on);
  command.flag("--plot", arguments->plot, "at the end draw the run into OUT/plot, as `taut plot OUT` does");
  arguments->pictures.offer(command);
  command
      .flag("--measure", arguments->measure,
            "at the end tell radial distribution, displacement and length of chains, of what is logged")
      .excludes(go_on);
  command.flag("--timings", arguments->timings, kTimings);
  command.json("print what summary.json holds, in place of the tables");
}

void add_resume(Commands& commands) {
  auto arguments = std::make_shared<ResumeArguments>();
  const Subcommand command =
      commands.add("resume", "go on with a run that was stopped or killed, or take more steps",
                   [arguments] { resume_run(*arguments); });
  command.option("folder", arguments->folder, "what the run was given as --out").required();
  command
      .option("--steps", arguments->steps,
              "so many more than were taken (if not said: what is left of the run's)")
      .positive();
  command
      .option("--set", arguments->settings,
              "what may change: run.log_every, run.trajectory_every, run.checkpoint_minutes, thermostat "
              "and barostat")
      .key_values();
  command.flag("--timings", arguments->timings, kTimings);
  command.flag("--yes", arguments->yes,
               "go on though log or trajectories are cut back to less than half, or are gone and begin anew");
  command.json("print what summary.json holds, in place of the tables");
}

}  // namespace taut
