#include "measures/run_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "base/errors.hpp"
#include "files/text_file.hpp"
#include "measures/csv.hpp"

namespace taut {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

}  // namespace

const std::vector<double>& RunLog::column(const LogColumn& column) const {
  static const std::vector<double> kEmpty;
  const auto at = std::ranges::find(titles, column.title);
  return at == titles.end() ? kEmpty : values[static_cast<std::size_t>(at - titles.begin())];
}

bool RunLog::has(std::string_view key) const {
  return std::ranges::any_of(column(key), [](double value) { return !std::isnan(value); });
}

void RunLog::append(const RunLog& next) {
  if (titles.empty()) {
    *this = next;
    return;
  }
  if (next.titles != titles) throw InputError("the segments' logs have different columns");
  if (next.rows() == 0 || rows() == 0) return;
  const double end = column("time_ps").back(), begin = next.column("time_ps").front();
  const bool again = begin < end;
  const std::size_t first = again || begin == end ? 1 : 0;  // its start is the end here
  for (std::size_t c = 0; c < titles.size(); ++c) {
    const double later = again && titles[c] == common_column("time_ps").title ? end - begin : 0;
    for (std::size_t row = first; row < next.rows(); ++row) values[c].push_back(next.values[c][row] + later);
  }
}

RunLog read_log(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "log.csv";
  std::error_code unreadable;
  if (!std::filesystem::exists(file, unreadable))
    throw InputError(fmt::format("{}: there is no such file; expected the folder of a run, as --out names it",
                                 file.string()));
  const std::string text = contents_of(file);
  RunLog log;
  std::size_t line = 1;
  for (std::size_t at = 0; at < text.size(); ++line) {
    const std::size_t end = text.find('\n', at);
    if (end == text.npos) break;  // cut off in writing
    if (line == 1) {
      log.titles = csv_rows(std::string_view(text).substr(at, end - at)).at(0);
      if (!log.titles[0].empty() && log.titles[0][0] == '#') log.titles[0].erase(0, 1);
      log.values.resize(log.titles.size());
    } else {
      const char* cell = text.data() + at;
      const char* const last = text.data() + end;
      for (std::size_t c = 0; c < log.titles.size(); ++c) {
        double value = kNone;
        const auto [stop, error] = std::from_chars(cell, last, value);
        const bool ends = stop == last || *stop == ',';
        if (!ends || (c + 1 < log.titles.size()) == (stop == last))
          throw InputError(fmt::format("{}:{}: expected {} numbers", file.string(), line, log.titles.size()));
        log.values[c].push_back(stop == cell ? kNone : value);
        cell = stop + 1;
      }
    }
    at = end + 1;
  }
  if (log.rows() == 0 || !log.has("time_ps"))
    throw InputError(
        fmt::format("{}: expected rows with a column \"{}\"", file.string(), common_column("time_ps").title));
  return log;
}

}  // namespace taut
