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
#include "base/words.hpp"
#include "files/folder.hpp"
#include "files/text_file.hpp"
#include "measures/csv.hpp"
#include "measures/run_log.hpp"
#include "printing.hpp"
#include "report.hpp"
#include "run_curves.hpp"
#include "run_frames.hpp"
#include "run_measured.hpp"
#include "simulation/checkpoint.hpp"
#include "study.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

// At most so many points: means of neighbours.
constexpr std::size_t kMostPoints = 500;

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
      const bool averaged = c.running_mean && t / time >= c.from;
      if (averaged) all += sum, spent += time;
      csv += fmt::format("{},{},{:.9g},{:.9g},{}\n", csv_cell(c.panel), csv_cell(c.name), t / time,
                         sum / time, averaged ? fmt::format("{:.9g}", all / spent) : "");
    }
  }
  return csv;
}

// The measured mean of each curve that has one.
std::string means_csv(const std::vector<Curve>& curves) {
  std::string csv = "panel,curve,from_ps,to_ps,value,standard_error\n";
  for (const Curve& c : curves)
    if (c.mean)
      csv += fmt::format("{},{},{:.9g},{:.9g},{:.9g},{:.3g}\n", csv_cell(c.panel), csv_cell(c.name), c.from,
                         c.t.back(), c.mean->value, c.mean->error);
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
  for (const Curve& c : curves) longest = std::max<std::size_t>(longest, width_of(c.name));
  for (const Curve& c : curves) {
    if (c.panel != panel) say("{}\n", c.panel);
    panel = c.panel;
    const auto [low, high] = std::ranges::minmax(c.y);
    say("  {}{}  {}  {:.5g} to {:.5g}\n", c.name, std::string(longest - width_of(c.name), ' '),
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
        csv += fmt::format("{},{},{:.7g},{:.3g}\n", csv_cell(names[k]), csv_cell(type + ": " + motion),
                           t["value"].get<double>(), t["error"].is_number() ? t["error"].get<double>() : 0.0);
      }
    if (scenes[k] && scenes[k]->run.thermostatted() && scenes[k]->run.temperature_course.empty())
      csv += fmt::format("{},bath,{:.7g},0\n", csv_cell(names[k]), scenes[k]->run.temperature_k);
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

// The curves of all runs, panel by panel, with what was measured of them.
std::vector<Curve> all_curves(const PlotRequest& request, const std::vector<std::string>& names,
                              const std::vector<std::optional<Scene>>& scenes,
                              const std::vector<std::optional<MeasuredRun>>& measured) {
  std::vector<Curve> curves;
  for (std::size_t k = 0; k < request.runs.size(); ++k)
    for (Curve& curve : curves_of(read_log(request.runs[k]), request.runs.size() > 1 ? names[k] : "",
                                  scenes[k] ? &*scenes[k] : nullptr, request.runs[k], request.most_frames)) {
      if (measured[k] && !curve.key.empty()) {
        curve.from = measured[k]->from_ps();
        for (const Figure& figure : measured[k]->figures())
          if (figure.key == curve.key) curve.mean = figure.value;
      }
      curves.push_back(std::move(curve));
    }
  std::vector<std::string> panels;
  for (const Curve& curve : curves)
    if (std::ranges::find(panels, curve.panel) == panels.end()) panels.push_back(curve.panel);
  std::ranges::stable_sort(curves, {}, [&](const Curve& c) { return std::ranges::find(panels, c.panel); });
  return curves;
}

}  // namespace

nlohmann::ordered_json plot_runs(const PlotRequest& request) {
  expect_no_file({request.out / "run.csv", request.out / "report.html"}, request.overwrite);
  for (const fs::path& run : request.runs) read_log(run);  // a wrong one is refused before any is measured
  const std::vector<std::string> names = legend_names(request.runs);
  std::vector<std::optional<Scene>> scenes;
  for (const fs::path& run : request.runs) scenes.push_back(scene_of(run));
  const std::string title =
      request.runs.size() == 1 ? request.runs[0].string() : counted(std::ssize(request.runs), "run");
  ReportPage page{.title = title, .command = request.command, .notes = {}, .parts = {}};
  const auto measured = measure_runs(request.runs, page, request.most_frames);
  const std::vector<Curve> curves = all_curves(request, names, scenes, measured);
  make_folder(request.out);
  StudyFiles files(request.out, request.pictures);
  Picture picture{"run", title, csv_of(curves), {{"means", means_csv(curves)}}};
  page.parts.push_back(
      {"The run in time",
       "Each row of the log, or means of neighbouring rows; over the measured part the mean up to each "
       "time. The account: total energy less the heat, from its start, and what the bonds did.",
       "",
       picture.csv,
       {}});
  if (const std::string kinds = kinds_csv(request.runs, names, scenes); std::ranges::count(kinds, '\n') > 1) {
    picture.beside["kinds"] = kinds;
    page.parts.push_back({"Temperatures",
                          "Of each type of molecule, by motion, over the whole run, beside the bath's.",
                          "",
                          kinds,
                          {}});
  }
  add_measured(measured, names, picture, page);
  if (request.runs.size() == 1 && scenes[0]) {
    picture.beside["frames"] = frames_csv(*scenes[0], request.runs[0]);
    page.parts.push_back(
        {"First and last frame",
         "Molecules are whole, with their centres in the box; nearer atoms hide those behind.",
         "",
         picture.beside["frames"],
         {}});
  }
  for (const std::string& panel : request.panels) {
    std::string& panels = picture.beside["panels"];
    panels += (panels.empty() ? "panel\n" : "") + csv_cell(panel) + "\n";
  }
  files.draw(picture);
  print_lines(curves);
  write_report(page, files);
  files.print_written();
  nlohmann::ordered_json json = {{"out", request.out.string()}};
  for (const Curve& curve : curves) {
    const auto [low, high] = std::ranges::minmax(curve.y);
    json["curves"].push_back({{"panel", curve.panel}, {"curve", curve.name}, {"min", low}, {"max", high}});
  }
  json["measured"] = nlohmann::ordered_json::array();
  for (const auto& run : measured)
    if (run) json["measured"].push_back(run->json());
  return json;
}

}  // namespace taut
