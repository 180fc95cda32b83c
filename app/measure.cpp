#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "base/words.hpp"
#include "commands.hpp"
#include "files/folder.hpp"
#include "measured_groups.hpp"
#include "printing.hpp"
#include "run_measured.hpp"
#include "study.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

struct MeasureArguments {
  std::vector<std::string> folders, atoms;
  std::optional<std::string> from;
  std::optional<double> last, viscosity;
  std::optional<fs::path> out;
  PictureOptions pictures;
  bool join = false, tensions = false, overwrite = false;

  MeasureSettings settings() const {
    MeasureSettings settings{
        .atoms = atoms, .from = {}, .last = last, .viscosity = viscosity, .tensions = tensions};
    if (from && last) throw InputError("--from and --last: one of them");
    if (!from) return settings;
    if (*from == "auto") {
      settings.automatic = true;
      return settings;
    }
    settings.from = number_in(*from);
    if (!settings.from || !std::isfinite(*settings.from))
      throw InputError(fmt::format("--from {}: expected a time in ps, or auto", *from));
    return settings;
  }
};

// The names that a measurement may write, with their pictures.
constexpr std::array kTableFiles = {"equilibration", "distances",     "displacement", "relaxation",
                                    "viscosity",     "each_run",      "scan",         "zero_step",
                                    "loads",         "loads_in_time", "mean_force"};

void write_files(const MeasureArguments& arguments, const auto& draw) {
  make_folder(*arguments.out);
  StudyFiles files(*arguments.out, arguments.pictures);
  draw(files);
  files.print_written();
}

// One run, in one folder or in segments.
void measure_one(const MeasureArguments& arguments, const MeasuredRun& run) {
  print_run(run);
  if (json_alone()) write_json(run.json());
  if (!arguments.out) return;
  write_files(arguments, [&](StudyFiles& files) {
    std::string csv = "figure,value,standard_error\n";
    for (const Figure& figure : run.figures())
      csv += fmt::format("{},{:.9g},{:.3g}\n", figure.key, figure.value.value, figure.value.error);
    files.write("figures.csv", csv);
    for (const Picture& picture : run.pictures()) files.draw(picture);
  });
}

void show_groups(const MeasureArguments& arguments, const MeasuredGroups& all, const Notes& notes) {
  all.print(notes);
  if (json_alone()) {
    const bool one = all.groups.size() == 1 && all.groups[0].values.empty();
    write_json(one ? json_of(all.groups[0]) : all.json());
  }
  if (arguments.out) write_files(arguments, [&](StudyFiles& files) { all.draw(files); });
}

void measure(const MeasureArguments& arguments) {
  const MeasureSettings settings = arguments.settings();
  const std::vector<fs::path> folders(arguments.folders.begin(), arguments.folders.end());
  if (arguments.out) {
    std::vector<fs::path> files = {*arguments.out / "figures.csv"};
    for (const char* table : kTableFiles) files.push_back(*arguments.out / (std::string(table) + ".csv"));
    expect_no_file(files, arguments.overwrite);
  }
  const bool scans = std::ranges::any_of(folders, is_scan);
  if (scans && folders.size() > 1) throw InputError("a scan is measured alone: give its folder and no other");
  if (arguments.tensions && (scans || (folders.size() > 1 && !arguments.join)))
    throw InputError("--tensions: of one run; give its folder alone, or the segments of one run with --join");
  Notes notes;
  if (scans) {
    const MeasuredGroups all =
        with_notes(notes, [&] { return MeasuredGroups{measure_scan(folders[0], settings, notes)}; });
    return show_groups(arguments, all, notes);
  }
  if (folders.size() == 1 || arguments.join) return measure_one(arguments, MeasuredRun(folders, settings));
  std::vector<RunGroup> groups;
  groups.push_back(with_notes(notes, [&] { return measure_group("", folders, settings, notes); }));
  groups[0].label = groups[0].runs.front().scene().name;
  show_groups(arguments, {std::move(groups)}, notes);
}

}  // namespace

void add_measure(Commands& commands) {
  auto arguments = std::make_shared<MeasureArguments>();
  const Subcommand command = commands.add(
      "measure",
      "of a run's log and trajectory: means with errors, viscosity, radial distribution, diffusion, chains",
      [arguments] { measure(*arguments); });
  command
      .option("folders", arguments->folders,
              "what runs were given as --out; several are runs that differ by their seed; or a scan's folder")
      .required();
  command.option("--from", arguments->from, "leave out what is before this time [ps]; auto: find it")
      .words(0, "PS|auto");
  command.option("--last", arguments->last, "measure so much at the end [ps]").positive();
  command.flag("--join", arguments->join, "the folders are one run's segments, in this order");
  command
      .option("--atoms", arguments->atoms,
              "pairs of the radial distribution, by name: OW HW1 (if not said: the heaviest)")
      .words(2, "NAME NAME");
  command
      .option(
          "--viscosity", arguments->viscosity,
          "by which diffusion is corrected for the box's size [mPa s] (if not said: the log's, if it tells)")
      .positive();
  command.flag("--tensions", arguments->tensions,
               "what each rigid bond carries: its mean tension, the least and the most, of trajectory.h5md");
  command.option("--out", arguments->out, "folder for the figures as CSV, with pictures");
  arguments->pictures.offer(command);
  command.flag("--overwrite", arguments->overwrite, "replace what --out holds");
  command.json("all figures as JSON");
}

}  // namespace taut
