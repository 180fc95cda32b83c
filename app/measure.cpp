#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "commands.hpp"
#include "files/folder.hpp"
#include "measure_groups.hpp"
#include "printing.hpp"
#include "scan_folder.hpp"
#include "study.hpp"
#include "zero_steps.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

struct MeasureArguments {
  std::vector<std::string> folders, atoms;
  std::optional<std::string> from;
  std::optional<double> last, viscosity;
  std::optional<fs::path> out;
  PictureOptions pictures;
  bool join = false, overwrite = false;

  MeasureSettings settings() const {
    MeasureSettings settings{.atoms = atoms, .from = {}, .last = last, .viscosity = viscosity};
    if (from && last) throw InputError("--from and --last: one of them");
    if (!from) return settings;
    if (*from == "auto") {
      settings.automatic = true;
      return settings;
    }
    double ps = 0;
    const auto [end, error] = std::from_chars(from->data(), from->data() + from->size(), ps);
    if (error != std::errc() || end != from->data() + from->size() || !std::isfinite(ps))
      throw InputError(fmt::format("--from {}: expected a time in ps, or auto", *from));
    settings.from = ps;
    return settings;
  }
};

// The names that a measurement may write, with their pictures.
constexpr std::array kTables = {"equilibration", "distances", "displacement", "relaxation",
                                "viscosity",     "each_run",  "scan",         "zero_step"};

void write_files(const MeasureArguments& arguments, const auto& draw) {
  make_folder(*arguments.out);
  StudyFiles files(*arguments.out, arguments.pictures);
  draw(files);
  files.print_written();
}

// One run, in one folder or in segments.
void measure_one(const MeasureArguments& arguments, const MeasuredRun& run) {
  run.print();
  if (json_alone())
    write_out(run.json().dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  if (!arguments.out) return;
  write_files(arguments, [&](StudyFiles& files) {
    std::string csv = "figure,value,standard_error\n";
    for (const Figure& figure : run.figures())
      csv += fmt::format("{},{:.9g},{:.3g}\n", figure.key, figure.value.value, figure.value.error);
    files.write("figures.csv", csv);
    for (const Picture& picture : run.pictures()) files.draw(picture);
  });
}

void measure_groups(const MeasureArguments& arguments, const std::vector<RunGroup>& groups) {
  for (const RunGroup& group : groups) print_group(group);
  const std::vector<ZeroSteps> zero_steps = at_zero_step(groups);
  for (const ZeroSteps& of : zero_steps) print_zero_steps(of);
  if (json_alone()) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const RunGroup& group : groups) json.push_back(json_of(group));
    for (const ZeroSteps& of : zero_steps) json.push_back(json_of(of));
    write_out((groups.size() == 1 && groups[0].values.empty() ? json[0] : json)
                  .dump(2, ' ', false, nlohmann::json::error_handler_t::replace) +
              "\n");
  }
  if (!arguments.out) return;
  write_files(arguments, [&](StudyFiles& files) {
    if (groups.size() == 1 && groups[0].values.empty())
      files.draw({"each_run", groups[0].label + ": each run, and their mean; bars: standard errors",
                  each_run_csv(groups[0])});
    else
      draw_scan(files, groups);
    if (!zero_steps.empty()) files.write(kZeroSteps, zero_steps_csv(zero_steps));
  });
}

void measure(const MeasureArguments& arguments) {
  const MeasureSettings settings = arguments.settings();
  const std::vector<fs::path> folders(arguments.folders.begin(), arguments.folders.end());
  if (arguments.out) {
    std::vector<fs::path> files = {*arguments.out / "figures.csv"};
    for (const char* table : kTables) files.push_back(*arguments.out / (std::string(table) + ".csv"));
    expect_no_file(files, arguments.overwrite);
  }
  const bool scans = std::ranges::any_of(folders, is_scan);
  if (scans && folders.size() > 1) throw InputError("a scan is measured alone: give its folder and no other");
  if (scans) {
    return measure_groups(arguments, measure_scan(folders[0], settings));
  }
  if (folders.size() == 1 || arguments.join) return measure_one(arguments, MeasuredRun(folders, settings));
  std::vector<RunGroup> groups;
  groups.push_back(measure_group("", folders, settings));
  groups[0].label = groups[0].runs.front().scene().name;
  measure_groups(arguments, groups);
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
  command.option("--out", arguments->out, "folder for the figures as CSV, with pictures");
  arguments->pictures.offer(command);
  command.flag("--overwrite", arguments->overwrite, "replace what --out holds");
  command.json("all figures as JSON");
}

}  // namespace taut
