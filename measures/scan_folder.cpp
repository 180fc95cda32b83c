#include "measures/scan_folder.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/errors.hpp"
#include "files/text_file.hpp"
#include "measures/csv.hpp"

namespace taut {

namespace fs = std::filesystem;

std::string in_words(const ScanValues& values) {
  std::string text;
  for (const auto& [key, value] : values) text += fmt::format("{}{}={}", text.empty() ? "" : " ", key, value);
  return text;
}

std::string ScanPoint::label() const {
  return values.empty() ? "all" : in_words(values);
}

bool is_scan(const fs::path& folder) {
  return fs::exists(folder / kScanTable);
}

std::vector<ScanPoint> scan_points(const fs::path& folder) {
  const auto rows = csv_rows(contents_of(folder / kScanTable));
  std::vector<ScanPoint> points;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    if (rows[k].size() != rows[0].size() || rows[0].size() < 2)
      throw InputError(fmt::format("{}/{}:{}: expected {} cells, got {}", folder.string(), kScanTable, k + 1,
                                   rows[0].size(), rows[k].size()));
    ScanPoint point;
    for (std::size_t c = 2; c < rows[k].size(); ++c) point.values.emplace_back(rows[0][c], rows[k][c]);
    auto at = std::ranges::find(points, point.values, &ScanPoint::values);
    if (at == points.end()) at = points.insert(points.end(), point);
    at->runs.push_back(folder / rows[k][0]);
  }
  return points;
}

std::string scan_table(const std::vector<ScanPoint>& points) {
  std::string text = "run,seed";
  for (const auto& [key, value] : points.at(0).values) text += "," + csv_cell(key);
  text += "\n";
  for (const ScanPoint& point : points)
    for (std::size_t seed = 0; seed < point.runs.size(); ++seed) {
      text += fmt::format("{},{}", csv_cell(point.runs[seed].filename().string()),
                          point.first_seed + static_cast<int>(seed));
      for (const auto& [key, value] : point.values) text += "," + csv_cell(value);
      text += "\n";
    }
  return text;
}

bool is_finished(const fs::path& run) {
  return fs::exists(run / "summary.json");
}

}  // namespace taut
