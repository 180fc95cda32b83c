#include "run_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/errors.hpp"
#include "base/even_times.hpp"
#include "files/folder.hpp"
#include "printing.hpp"
#include "report.hpp"
#include "run_curves.hpp"
#include "run_frames.hpp"
#include "run_measured.hpp"
#include "simulation/checkpoint.hpp"
#include "studies/csv.hpp"
#include "studies/run_log.hpp"
#include "study.hpp"
#include "words.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

// At most so many points: means of neighbours.
constexpr std::size_t kMostPoints = 1000;

std::string csv_of(const std::vector<Curve>& curves) {
  std::string csv = "panel,curve,t_ps,value,running_mean\n";
  for (const Curve& c : curves) {
    const std::size_t bin = (c.y.size() + kMostPoints - 1) / kMostPoints;
    const std::vector<double> spans = spans_of(c.t);  // rows weigh as the time they stand for
    double all = 0, spent = 0;
    for (std::size_t first = 0; first < c.y.size(); first += bin) {
      double t = 0, sum = 0, time = 0;
      for (std::size_t k = first; k < std::min(first + bin, c.y.size()); ++k)
        t += spans[k] * c.t[k], sum += spans[k] * c.y[k], time += spans[k];
      all += sum, spent += time;
      csv += fmt::format("{},{},{:.9g},{:.9g},{}\n", label_cell(c.panel), label_cell(c.name), t / time,
                         sum / time, c.running_mean ? fmt::format("{:.9g}", all / spent) : "");
    }
  }
  return csv;
}

// A line of eight heights, the least value lowest.
std::string coarse_line(const std::vector<double>& y, std::size_t width) {
  constexpr std::array kHeights = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  const auto [low, high] = std::ranges::minmax(y);
  const std::size_t columns = std::min(width, y.size());
  std::string line;
  for (std::size_t c = 0; c < columns; ++c) {
    const std::size_t first = c * y.size() / columns, end = (c + 1) * y.size() / columns;
    double sum = 0;
    for (std::size_t k = first; k < end; ++k) sum += y[k];
    const double share = high > low ? (sum / static_cast<double>(end - first) - low) / (high - low) : 0.5;
    line += kHeights[std::min<std::size_t>(7, static_cast<std::size_t>(std::max(0.0, 8 * share)))];
  }
  return line;
}

void print_lines(const std::vector<Curve>& curves) {
  std::string panel;
  std::size_t longest = 0;
  for (const Curve& c : curves) longest = std::max<std::size_t>(longest, columns_of(c.name));
  for (const Curve& c : curves) {
    if (c.panel != panel) say("{}\n", c.panel);
    panel = c.panel;
    const auto [low, high] = std::ranges::minmax(c.y);
    say("  {}{}  {}  {:.5g} to {:.5g}\n", c.name, std::string(longest - columns_of(c.name), ' '),
        coarse_line(c.y, 50), low, high);
  }
}

// type, motion, temperature and error of each run that is finished, and its bath; the header alone where there is none.
std::string kinds_csv(const std::vector<fs::path>& runs, const std::vector<std::string>& names,
                      const std::vector<std::optional<Scene>>& scenes) {
  std::string csv = "run,kind,temperature_k,standard_error\n";
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const auto summary = nlohmann::ordered_json::parse(contents_of(runs[k] / "summary.json"), nullptr, false);
    if (!summary.is_object() || !summary.contains("temperatures_k")) continue;
    for (const auto& [type, motions] : summary["temperatures_k"].items())
      for (const auto& [motion, t] : motions.items()) {
        if (!t.contains("value")) continue;  // an older taut's summary
        csv += fmt::format("{},{},{:.7g},{:.3g}\n", label_cell(names[k]), label_cell(type + ": " + motion),
                           t["value"].get<double>(), t["error"].is_number() ? t["error"].get<double>() : 0.0);
      }
    if (scenes[k] && scenes[k]->run.thermostatted() && scenes[k]->run.temperature_course.empty())
      csv += fmt::format("{},bath,{:.7g},0\n", label_cell(names[k]), scenes[k]->run.temperature_k);
  }
  return csv;
}

// The scene of a run, if its checkpoint is there to say it.
std::optional<Scene> scene_of(const fs::path& run) {
  if (!fs::exists(checkpoint_file(run))) return {};
  return load_checkpoint(run).source.read();
}

// The names of folders in a legend: the last parts of their paths, as few as tell them apart.
std::vector<std::string> legend_names(const std::vector<fs::path>& runs) {
  std::vector<std::string> names(runs.size());
  std::vector<fs::path> rest;
  for (const fs::path& run : runs) rest.push_back(backup_base(run));
  for (bool alike = true, more = true; alike && more;) {
    more = false;
    for (std::size_t k = 0; k < runs.size(); ++k) {
      if (!rest[k].has_filename()) continue;
      names[k] = rest[k].filename().string() + (names[k].empty() ? "" : "/" + names[k]);
      rest[k] = rest[k].parent_path();
      more = true;
    }
    alike = std::ranges::any_of(names, [&](const auto& name) { return std::ranges::count(names, name) > 1; });
  }
  return names;
}

}  // namespace

nlohmann::ordered_json plot_runs(const PlotRequest& request) {
  expect_no_file({request.out / "run.csv", request.out / "report.html"}, request.overwrite);
  std::vector<RunLog> logs;
  for (const fs::path& run : request.runs) logs.push_back(read_log(run));
  const std::vector<std::string> names = legend_names(request.runs);
  std::vector<std::optional<Scene>> scenes;
  for (const fs::path& run : request.runs) scenes.push_back(scene_of(run));
  std::vector<Curve> curves;
  for (std::size_t k = 0; k < request.runs.size(); ++k)
    for (Curve& curve : curves_of(logs[k], request.runs.size() > 1 ? names[k] : "",
                                  scenes[k] ? &*scenes[k] : nullptr, request.runs[k], request.most_frames))
      curves.push_back(std::move(curve));
  std::vector<std::string> panels;
  for (const Curve& curve : curves)
    if (std::ranges::find(panels, curve.panel) == panels.end()) panels.push_back(curve.panel);
  std::ranges::stable_sort(curves, {}, [&](const Curve& c) { return std::ranges::find(panels, c.panel); });
  const std::string title =
      request.runs.size() == 1 ? request.runs[0].string() : counted(std::ssize(request.runs), "run");
  make_folder(request.out);
  StudyFiles files(request.out);
  const std::string csv = csv_of(curves), kinds = kinds_csv(request.runs, names, scenes);
  ReportPage page{.title = title, .command = request.command, .notes = {}, .parts = {}};
  files.draw({"run", title + ": each row, and running means as thick lines", csv});
  page.parts.push_back(
      {"The run in time",
       "Each row of the log, or means of neighbouring rows, and the mean from the start up to each "
       "time. The account: total energy less the heat, from its start, and what the bonds did.",
       "run.svg",
       csv,
       {}});
  if (std::ranges::count(kinds, '\n') > 1) {
    files.draw(
        {"kinds", title + ": temperature by type of molecule and motion, bars: standard errors", kinds});
    page.parts.push_back({"Temperatures",
                          "Of each type of molecule, by motion, over the whole run, beside the bath's.",
                          "kinds.svg",
                          kinds,
                          {}});
  }
  if (request.runs.size() == 1 && scenes[0]) {
    const std::string frames = frames_csv(*scenes[0], request.runs[0]);
    files.draw({"frames", title + ": atoms and bonds", frames});
    page.parts.push_back(
        {"First and last frame",
         "Molecules are whole, with their centres in the box; nearer atoms hide those behind.",
         "frames.svg",
         frames,
         {}});
  }
  print_lines(curves);
  const nlohmann::ordered_json measured =
      show_measured(request.runs, names, files, page, request.most_frames);
  write_report(page, files);
  files.print_written();
  nlohmann::ordered_json json = {{"out", request.out.string()}};
  for (const Curve& curve : curves) {
    const auto [low, high] = std::ranges::minmax(curve.y);
    json["curves"].push_back({{"panel", curve.panel}, {"curve", curve.name}, {"min", low}, {"max", high}});
  }
  json["measured"] = measured;
  return json;
}

}  // namespace taut
