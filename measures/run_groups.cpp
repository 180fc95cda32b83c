#include "measures/run_groups.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "base/words.hpp"
#include "measures/csv.hpp"

namespace taut {

RunGroup measure_group(const std::string& label, const std::vector<std::filesystem::path>& folders,
                       const MeasureSettings& settings, Notes& notes) {
  RunGroup group{.values = {}, .label = label, .runs = {}, .figures = {}};
  for (const std::filesystem::path& folder : folders) group.runs.emplace_back(std::vector{folder}, settings);
  std::vector<std::vector<Figure>> figures;
  for (const MeasuredRun& run : group.runs) {
    const MeasuredRun& first = group.runs.front();
    if (run.scene().name != first.scene().name)
      throw InputError(
          fmt::format("{} is a run of \"{}\", {} of \"{}\": expected runs of one scene that differ "
                      "by their seed; measure them one by one",
                      first.name(), first.scene().name, run.name(), run.scene().name));
    if (&run != &first && run.scene().run.seed == first.scene().run.seed)
      notes.push_back(fmt::format("{} and {} have the same seed, {}: their means are not independent",
                                  first.name(), run.name(), run.scene().run.seed));
    figures.push_back(run.figures());
  }
  group.figures = over_seeds(figures);
  return group;
}

std::vector<RunGroup> measure_scan(const std::filesystem::path& folder, const MeasureSettings& settings,
                                   Notes& notes) {
  std::vector<RunGroup> groups;
  for (const ScanPoint& point : scan_points(folder)) {
    std::vector<std::filesystem::path> finished;
    std::ranges::copy_if(point.runs, std::back_inserter(finished), is_finished);
    if (finished.size() < point.runs.size())
      notes.push_back(
          fmt::format("{}: {} of {} runs are finished", point.label(), finished.size(), point.runs.size()));
    if (finished.empty()) continue;
    groups.push_back(measure_group(point.label(), finished, settings, notes));
    groups.back().values = point.values;
  }
  if (groups.empty()) throw InputError(fmt::format("{}: no run of the scan is finished", folder.string()));
  return groups;
}

std::string in_words(const RunGroup& group, int width) {
  std::vector<std::vector<std::string>> rows = {{"", "", "", "by blocks", "by seeds"}};
  for (const OverSeeds& o : group.figures)
    rows.push_back({"  " + o.figure.words, with_error(o.figure.value), o.figure.unit,
                    fmt::format("{:.2g}", o.from_blocks),
                    o.runs > 1 ? fmt::format("{:.2g}", o.from_seeds) : "one run"});
  return fmt::format("{}: mean of {}; the error is the larger of the last two columns\n", group.label,
                     counted(std::ssize(group.runs), "run")) +
         table_text(rows, width);
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
  std::string csv = kEachRunHeader;
  for (const OverSeeds& o : group.figures) {
    long number = 0;
    for (const MeasuredRun& run : group.runs)
      for (const Figure& figure : run.figures())
        if (figure.key == o.figure.key) csv += each_run_row(figure, run.name(), ++number);
    csv += each_run_row(o.figure, "mean", 0);
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
    if (const auto number = number_in(text)) numbers.push_back(*number);
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

Picture picture_of(const std::vector<RunGroup>& groups) {
  if (groups.size() == 1 && groups[0].values.empty())
    return {"each_run",
            groups[0].runs.front().scene().name + ": each run, and their mean; bars: standard errors",
            each_run_csv(groups[0])};
  return {"scan", "means over seeds, bars: standard errors", points_csv(groups)};
}

}  // namespace taut
