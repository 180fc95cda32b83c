#include "studies/chart_verdict.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "studies/csv.hpp"

namespace taut {
namespace {

struct Limit {
  double error;
  const char* text;
};
constexpr Limit kLimits[] = {{1e-4, "1e-4"}, {1e-6, "1e-6"}, {1e-9, "1e-9"}};
constexpr Limit kGood = kLimits[1];  // of what is recommended

// A setting that got through, as both tables have it.
struct Point {
  std::string method, name;
  double error = 0, low = 0, cost = 0, high = 0;  // rms, relative; ns a bond and step with its quartiles
  std::optional<bool> keeps_energy;               // none: the drift has no interval, or the run failed
};

using Row = std::map<std::string, std::string>;

std::vector<Row> rows_by_name(const std::string& csv) {
  const auto cells = csv_rows(csv);
  std::vector<Row> rows;
  for (std::size_t k = 1; k < cells.size(); ++k) {
    Row& row = rows.emplace_back();
    for (std::size_t c = 0; c < std::min(cells[k].size(), cells[0].size()); ++c)
      row[cells[0][c]] = cells[k][c];
  }
  return rows;
}

double number(const Row& row, const std::string& column) {
  const auto at = row.find(column);
  return at == row.end() || at->second.empty() ? std::nan("") : std::stod(at->second);
}

std::string name_of(const Row& row) {
  const std::string& parameter = row.at("parameter");
  return parameter.empty() ? row.at("method")
                           : fmt::format("{} ({} {})", row.at("method"), parameter, row.at("value"));
}

std::vector<Point> points_of(const std::string& work_csv, const std::string& drift_csv) {
  std::map<std::string, bool> keeps;
  for (const Row& row : rows_by_name(drift_csv)) {
    const double low = number(row, "drift_low"), high = number(row, "drift_high");
    if (high > low) keeps[name_of(row)] = low <= 0 && 0 <= high;
  }
  std::vector<Point> points;
  for (const Row& row : rows_by_name(work_csv)) {
    if (!row.at("failure").empty()) continue;
    Point p{.method = row.at("method"),
            .name = name_of(row),
            .error = number(row, "rms_rel_bond_error"),
            .low = number(row, "ns_per_bond_step_q1"),
            .cost = number(row, "ns_per_bond_step"),
            .high = number(row, "ns_per_bond_step_q3"),
            .keeps_energy = {}};
    if (const auto at = keeps.find(p.name); at != keeps.end()) p.keeps_energy = at->second;
    points.push_back(std::move(p));
  }
  std::ranges::stable_sort(points, {}, &Point::cost);
  return points;
}

// The cheapest of those that fit, and those of other methods that the quartiles do not tell from it.
std::string cheapest(const std::vector<Point>& points, const auto& fits) {
  std::vector<std::string> names, methods;
  double high = 0;
  for (const Point& p : points) {
    if (!fits(p) || std::ranges::count(methods, p.method) > 0) continue;
    if (!names.empty() && p.low > high) continue;
    if (names.empty()) high = p.high;
    names.push_back(fmt::format("{}, {:.3g} ns a bond", p.name, p.cost));
    methods.push_back(p.method);
  }
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, " or "));
}

}  // namespace

std::vector<std::string> chart_verdict(const std::string& work_csv, const std::string& drift_csv,
                                       double dt_fs) {
  const std::vector<Point> points = points_of(work_csv, drift_csv);
  std::vector<std::string> lines;
  std::string below;
  for (const Limit& limit : kLimits)
    below += fmt::format("{}{}: {}", below.empty() ? "" : "; ", limit.text,
                         cheapest(points, [&](const Point& p) { return p.error < limit.error; }));
  lines.push_back("cheapest with rms error below " + below);
  std::vector<std::string> keep, methods;
  bool judged = false;
  for (const Point& p : points) {
    judged = judged || p.keeps_energy;
    if (!p.keeps_energy.value_or(false) || std::ranges::count(methods, p.method) > 0) continue;
    keep.push_back(p.name);
    methods.push_back(p.method);
  }
  if (!judged) {
    lines.push_back(fmt::format(
        "keeps energy within error at {:g} fs: not known, the runs are too short for an error of the "
        "drift",
        dt_fs));
    return lines;
  }
  lines.push_back(fmt::format("keeps energy within error at {:g} fs, the cheapest setting of each method: {}",
                              dt_fs, keep.empty() ? "none" : fmt::format("{}", fmt::join(keep, ", "))));
  const auto does_both = [](const Point& p) {
    return p.keeps_energy.value_or(false) && p.error < kGood.error;
  };
  if (const std::string take = cheapest(points, does_both); take != "none")
    lines.push_back(fmt::format("take here: {}; the cheapest with rms error below {} that keeps the energy",
                                take, kGood.text));
  return lines;
}

std::string warn_of_load(double load, long cores) {
  if (static_cast<double>(cores) - load >= 0.5) return "";
  return fmt::format(
      "the machine is busy (load {:.1f} of {} core{} in the last minute): the times are noise; chart again "
      "when it "
      "is idle",
      load, cores, cores == 1 ? "" : "s");
}

}  // namespace taut
