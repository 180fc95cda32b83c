#include "measure_groups.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "measures/csv.hpp"
#include "printing.hpp"
#include "scan_folder.hpp"
#include "words.hpp"

namespace taut {

RunGroup group_runs(std::string label, std::vector<MeasuredRun> runs) {
  RunGroup group{.values = {}, .label = std::move(label), .runs = std::move(runs), .figures = {}};
  std::vector<std::vector<Figure>> figures;
  for (const MeasuredRun& run : group.runs) {
    const MeasuredRun& first = group.runs.front();
    if (run.scene().name != first.scene().name)
      throw InputError(
          fmt::format("{} is a run of \"{}\", {} of \"{}\": expected runs of one scene that differ "
                      "by their seed; measure them one by one",
                      first.name(), first.scene().name, run.name(), run.scene().name));
    if (&run != &first && run.scene().run.seed == first.scene().run.seed)
      say("note: {} and {} have the same seed, {}: their means are not independent\n", first.name(),
          run.name(), run.scene().run.seed);
    figures.push_back(run.figures());
  }
  group.figures = over_seeds(figures);
  return group;
}

RunGroup measure_group(const std::string& label, const std::vector<std::filesystem::path>& folders,
                       const MeasureSettings& settings) {
  std::vector<MeasuredRun> runs;
  for (const std::filesystem::path& folder : folders) runs.emplace_back(std::vector{folder}, settings);
  return group_runs(label, std::move(runs));
}

std::vector<RunGroup> measure_scan(const std::filesystem::path& folder, const MeasureSettings& settings) {
  std::vector<RunGroup> groups;
  for (const ScanPoint& point : scan_points(folder)) {
    std::vector<std::filesystem::path> finished;
    std::ranges::copy_if(point.runs, std::back_inserter(finished), is_finished);
    if (finished.size() < point.runs.size())
      say("note: {}: {} of {} runs are finished\n", point.label(), finished.size(), point.runs.size());
    if (finished.empty()) continue;
    groups.push_back(measure_group(point.label(), finished, settings));
    groups.back().values = point.values;
  }
  if (groups.empty()) throw InputError(fmt::format("{}: no run of the scan is finished", folder.string()));
  return groups;
}

void draw_scan(StudyFiles& files, const std::vector<RunGroup>& groups) {
  files.draw({"scan", "means over seeds, bars: standard errors", points_csv(groups)});
}

void print_group(const RunGroup& group) {
  say("{}: mean of {}; the error is the larger of the last two columns\n", group.label,
      counted(std::ssize(group.runs), "run"));
  std::vector<std::vector<std::string>> rows = {{"", "", "", "by blocks", "by seeds"}};
  for (const OverSeeds& o : group.figures)
    rows.push_back({"  " + o.figure.words, with_error(o.figure.value), o.figure.unit,
                    fmt::format("{:.2g}", o.from_blocks),
                    o.runs > 1 ? fmt::format("{:.2g}", o.from_seeds) : "one run"});
  say_text(table_text(rows, terminal_width()));
  if (json_alone()) return;
  for (const MeasuredRun& run : group.runs)
    for (const std::string& doubt : run.doubts())
      say_always(fmt::format("in doubt: {}: {}\n", run.name(), doubt));
}

nlohmann::ordered_json json_of(const RunGroup& group) {
  nlohmann::ordered_json json = {{"label", group.label}};
  for (const auto& [key, value] : group.values) json["values"][key] = value;
  for (const OverSeeds& o : group.figures)
    json["mean"][o.figure.key] = {{"value", o.figure.value.value},
                                  {"error", o.figure.value.error},
                                  {"error_by_blocks", o.from_blocks},
                                  {"error_by_seeds", o.from_seeds},
                                  {"runs", o.runs}};
  for (const MeasuredRun& run : group.runs) json["runs"].push_back(run.json());
  return json;
}

std::string each_run_csv(const RunGroup& group) {
  std::string csv = "figure,unit,run,number,value,standard_error\n";
  for (const OverSeeds& o : group.figures) {
    long number = 0;
    const auto row = [&](const std::string& run, long at, const Estimate& e) {
      csv += fmt::format("{},{},{},{},{:.9g},{:.3g}\n", csv_cell(o.figure.words), csv_cell(o.figure.unit),
                         csv_cell(run), at, e.value, e.error);
    };
    for (const MeasuredRun& run : group.runs)
      for (const Figure& figure : run.figures())
        if (figure.key == o.figure.key) row(run.name(), ++number, figure.value);
    row("mean", 0, o.figure.value);
  }
  return csv;
}

namespace {

// The values of the first key as numbers, or their places in the scan where one is no number: then `words` is set.
std::vector<double> along_x(const std::vector<RunGroup>& groups, bool& words) {
  std::vector<double> numbers, places;
  std::vector<std::string> seen;
  for (const RunGroup& group : groups) {
    const std::string& text = group.values.at(0).second;
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error == std::errc() && end == text.data() + text.size()) numbers.push_back(number);
    auto at = std::ranges::find(seen, text);
    if (at == seen.end()) at = seen.insert(seen.end(), text);
    places.push_back(static_cast<double>(at - seen.begin() + 1));
  }
  words = numbers.size() < groups.size();
  return words ? places : numbers;
}

// What distinguishes the curves: all keys but the first.
std::string curve_of(const RunGroup& group) {
  std::string text;
  for (std::size_t k = 1; k < group.values.size(); ++k)
    text += (text.empty() ? "" : " ") + group.values[k].second;
  return text.empty() ? group.runs.front().scene().name : text;
}

}  // namespace

std::string points_csv(const std::vector<RunGroup>& groups) {
  std::string csv = "figure,unit,x_name,x,x_text,curve,method,value,standard_error,runs\n";
  bool words = false;
  const std::vector<double> x = along_x(groups, words);
  std::vector<std::string> order;
  for (const RunGroup& group : groups)
    for (const OverSeeds& o : group.figures)
      if (std::ranges::find(order, o.figure.key) == order.end()) order.push_back(o.figure.key);
  std::vector<std::string> curves;
  for (const RunGroup& group : groups)
    if (const std::string curve = curve_of(group); std::ranges::find(curves, curve) == curves.end())
      curves.push_back(curve);
  for (const std::string& key : order)
    for (const std::string& curve : curves)
      for (std::size_t g = 0; g < groups.size(); ++g)
        for (const OverSeeds& o : groups[g].figures)
          if (o.figure.key == key && curve_of(groups[g]) == curve)
            csv += fmt::format("{},{},{},{:.9g},{},{},{},{:.9g},{:.3g},{}\n", csv_cell(o.figure.words),
                               csv_cell(o.figure.unit), csv_cell(groups[g].values[0].first), x[g],
                               words ? csv_cell(groups[g].values[0].second) : "-", csv_cell(curve),
                               groups[g].runs.front().scene().method.name(), o.figure.value.value,
                               o.figure.value.error, o.runs);
  return csv;
}

}  // namespace taut
