#include "studies/run_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "base/errors.hpp"
#include "studies/csv.hpp"

namespace taut {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::size_t index_of(const RunLog& log, std::string_view name) {
  return static_cast<std::size_t>(std::ranges::find(log.columns, name) - log.columns.begin());
}

}  // namespace

const std::vector<double>& RunLog::column(std::string_view name) const {
  static const std::vector<double> kEmpty;
  const std::size_t at = index_of(*this, name);
  return at < columns.size() ? values[at] : kEmpty;
}

bool RunLog::has(std::string_view name) const {
  return std::ranges::any_of(column(name), [](double value) { return !std::isnan(value); });
}

double RunLog::interval() const {
  const std::vector<double>& t = column(kLogTime);
  return t.size() < 2 ? 0.0 : t[1] - t[0];
}

void RunLog::append(const RunLog& next) {
  if (columns.empty()) {
    *this = next;
    return;
  }
  if (next.columns != columns) throw InputError("the segments' logs have different columns");
  const std::size_t time = index_of(*this, kLogTime);
  if (next.rows() == 0 || rows() == 0 || time == columns.size()) return;
  const double end = values[time].back(), begin = next.values[time].front();
  const bool again = begin < end;
  const std::size_t first = again || begin == end ? 1 : 0;  // its start is the end here
  for (std::size_t c = 0; c < columns.size(); ++c)
    for (std::size_t row = first; row < next.rows(); ++row)
      values[c].push_back(next.values[c][row] + (c == time && again ? end - begin : 0));
}

RunLog read_log(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "log.csv";
  std::ifstream in(file, std::ios::binary);
  if (!in)
    throw InputError(fmt::format("{}: there is no such file; expected the folder of a run, as --out names it",
                                 file.string()));
  std::ostringstream whole;
  whole << in.rdbuf();
  const std::string text = whole.str();
  RunLog log;
  std::size_t line = 1;
  for (std::size_t at = 0; at < text.size(); ++line) {
    const std::size_t end = text.find('\n', at);
    if (end == text.npos) break;  // cut off in writing
    if (line == 1) {
      log.columns = csv_rows(std::string_view(text).substr(at, end - at)).at(0);
      if (!log.columns[0].empty() && log.columns[0][0] == '#') log.columns[0].erase(0, 1);
      log.values.resize(log.columns.size());
    } else {
      const char* cell = text.data() + at;
      const char* const last = text.data() + end;
      for (std::size_t c = 0; c < log.columns.size(); ++c) {
        double value = kNone;
        const auto [stop, error] = std::from_chars(cell, last, value);
        const bool ends = stop == last || *stop == ',';
        if (!ends || (c + 1 < log.columns.size()) == (stop == last))
          throw InputError(
              fmt::format("{}:{}: expected {} numbers", file.string(), line, log.columns.size()));
        log.values[c].push_back(stop == cell ? kNone : value);
        cell = stop + 1;
      }
    }
    at = end + 1;
  }
  if (log.rows() == 0 || !log.has(kLogTime))
    throw InputError(fmt::format("{}: expected rows with a column \"{}\"", file.string(), kLogTime));
  return log;
}

}  // namespace taut
