#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "measured_run.hpp"

namespace taut {

// Runs that differ by their seed, and what they say together.
struct RunGroup {
  std::vector<std::pair<std::string, std::string>> values;  // what a scan varies: key and value; may be empty
  std::string label;
  std::vector<MeasuredRun> runs;
  std::vector<OverSeeds> figures;
};
RunGroup group_runs(std::string label, std::vector<MeasuredRun> runs);
RunGroup measure_group(const std::string& label, const std::vector<std::filesystem::path>& folders,
                       const MeasureSettings& settings);

// Measures the finished runs of a scan, a group for each of its points. Throws InputError where none is finished.
std::vector<RunGroup> measure_scan(const std::filesystem::path& folder, const MeasureSettings& settings);

// scan.csv and its picture: every figure along the first key that was varied.
void draw_scan(StudyFiles& files, const std::vector<RunGroup>& groups);

void print_group(const RunGroup& group);  // a line a figure, its error, and where that comes from
nlohmann::ordered_json json_of(const RunGroup& group);

// figure, unit, run and its number, value, error: a row for each figure of each run, and one for the mean, whose
// number is 0.
std::string each_run_csv(const RunGroup& group);

// figure, unit, x (the first key's value, or its place where values are words), x_text (the word), curve (the others' values), value,
// error, runs: a row for each figure and group.
std::string points_csv(const std::vector<RunGroup>& groups);

}  // namespace taut
