#include <fmt/format.h>

#include <array>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "command_line.hpp"
#include "commands.hpp"
#include "files/folder.hpp"
#include "files/text_file.hpp"
#include "measures/scan_folder.hpp"
#include "printing.hpp"
#include "run_picture.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

struct PlotArguments {
  std::vector<std::string> folders;
  std::optional<std::filesystem::path> out;
  std::optional<long> frames;
  PictureOptions pictures;
  std::vector<std::string> panels;
  bool overwrite = false;
};

// The tables of studies and measurements that have a picture.
constexpr std::array kStudyTables = {
    "work",          "drift",      "order",     "length",       "precision",     "plane",
    "steps",         "crosscheck", "distances", "displacement", "relaxation",    "viscosity",
    "equilibration", "each_run",   "scan",      "loads",        "loads_in_time", "mean_force"};

// Draws what a folder of a study or a measurement has tables of, in another size or form. Returns false where it has none.
bool draw_again(const PlotArguments& arguments) {
  const fs::path folder = arguments.folders[0];
  if (arguments.folders.size() > 1 || fs::exists(folder / "log.csv") || is_scan(folder)) return false;
  for (const auto& [option, given] :
       {std::pair("--panels", !arguments.panels.empty()), {"--frames", arguments.frames.has_value()}})
    if (given)
      throw InputError(fmt::format("{}: needs runs; these are tables, with one picture each", option));
  StudyFiles files(arguments.out.value_or(folder), arguments.pictures);
  bool any = false;
  for (const char* name : kStudyTables)
    if (const std::string csv = contents_of(folder / (std::string(name) + ".csv")); !csv.empty()) {
      if (!any) make_folder(files.folder());
      any = true;
      files.draw({name, "", csv, {{"limits", contents_of(folder / "limits.csv")}}});
    }
  if (any) files.print_written();
  if (any && json_alone()) write_json({{"out", files.folder().string()}});
  return any;
}

void plot(const PlotArguments& arguments) {
  if (draw_again(arguments)) return;
  if (arguments.frames.value_or(0) < 0)
    throw InputError("--frames: expected a number of frames, or 0 for all");
  PlotRequest request{.runs = {},
                      .out = {},
                      .command = "taut plot",
                      .pictures = arguments.pictures,
                      .panels = arguments.panels,
                      .overwrite = arguments.overwrite,
                      .most_frames = arguments.frames.value_or(kMostFramesDrawn)};
  for (const std::string& folder : arguments.folders) {
    request.command += " " + quoted_for_shell(folder);
    if (!is_scan(folder)) {
      request.runs.emplace_back(folder);
      continue;
    }
    for (const ScanPoint& point : scan_points(folder))
      for (const std::filesystem::path& run : point.runs)
        if (is_finished(run)) request.runs.push_back(run);
  }
  if (request.runs.empty()) throw InputError(arguments.folders[0] + ": no run of the scan is finished");
  request.out = arguments.out.value_or(std::filesystem::path(arguments.folders[0]) / "plot");
  const nlohmann::ordered_json drawn = plot_runs(request);
  if (json_alone()) write_json(drawn);
}

}  // namespace

void add_plot(Commands& commands) {
  auto arguments = std::make_shared<PlotArguments>();
  const Subcommand command = commands.add(
      "plot", "draw runs: energies and their account, temperature, pressure, density, bond errors",
      [arguments] { plot(*arguments); });
  command
      .option("folders", arguments->folders,
              "what runs were given as --out; several are laid over each other; or a scan's folder, or a "
              "study's to draw "
              "it again")
      .required();
  command.option("--out", arguments->out, "folder of the pictures and report.html (DIR/plot of the first)");
  command.option("--frames", arguments->frames,
                 "of each trajectory so many frames are read at most, evenly spaced (2000); 0: all");
  command
      .option("--panels", arguments->panels,
              "of a run's picture, by parts of their titles: temperature frame (if not said: all)")
      .words(0, "WORD");
  arguments->pictures.offer(command);
  command.flag("--overwrite", arguments->overwrite, "replace what --out holds");
  command.json("the range of each curve as JSON; run.csv has all points");
}

}  // namespace taut
