#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "measures/measured_run.hpp"
#include "measures/scan_folder.hpp"

namespace taut {

// Runs that differ by their seed, and what they say together.
struct RunGroup {
  ScanValues values;  // empty: of no scan
  std::string label;
  std::vector<MeasuredRun> runs;
  std::vector<OverSeeds> figures;
};
using Notes = std::vector<std::string>;  // what the user should know of, a line each

RunGroup measure_group(const std::string& label, const std::vector<std::filesystem::path>& folders,
                       const MeasureSettings& settings, Notes& notes);

// Measures the finished runs of a scan, a group for each of its points. Throws InputError where none is finished.
std::vector<RunGroup> measure_scan(const std::filesystem::path& folder, const MeasureSettings& settings,
                                   Notes& notes);

// A line a figure, its error, and where that comes from.
std::string in_words(const RunGroup& group, int width);
nlohmann::ordered_json json_of(const RunGroup& group);

// Every figure of groups along the first key that was varied; of one group that no scan varies, of each run.
Picture picture_of(const std::vector<RunGroup>& groups);

std::string each_run_csv(const RunGroup& group);

// figure, unit, x (the first key's value, or its place where values are words), x_text (the word), curve (the others'
// values), value, error, runs: a row for each figure and group.
std::string points_csv(const std::vector<RunGroup>& groups);

}  // namespace taut
