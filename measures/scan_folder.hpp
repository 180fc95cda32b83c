#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace taut {

inline constexpr const char* kScanTable = "runs.csv";

using ScanValues =
    std::vector<std::pair<std::string, std::string>>;  // keys that a scan varies, and their values
std::string in_words(const ScanValues& values);        // "run.temperature_k=300 method.name=newton"

// One setting of a scan, and the folders of its runs, which differ by their seed.
struct ScanPoint {
  ScanValues values;
  std::vector<std::filesystem::path> runs;
  int first_seed = 1;  // of the first run, one more of each that follows

  std::string label() const;  // its values, or "all"
};

bool is_scan(const std::filesystem::path& folder);

// The points of a scan in their order, as FOLDER/runs.csv lists them: run, seed and a column for each key.
// Throws InputError.
std::vector<ScanPoint> scan_points(const std::filesystem::path& folder);
std::string scan_table(const std::vector<ScanPoint>& points);  // runs.csv

// Whether a run in a folder has taken all its steps.
bool is_finished(const std::filesystem::path& run);

}  // namespace taut
