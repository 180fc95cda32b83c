#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/log_columns.hpp"

namespace taut {

// The rows of a run's log.csv, column by column.
struct RunLog {
  std::vector<std::string> titles;          // of the columns: "Time (ps)", "Temperature (K)", ...
  std::vector<std::vector<double>> values;  // of each column; NaN for an empty cell

  std::size_t rows() const { return values.empty() ? 0 : values[0].size(); }
  // Returns an empty list if the log has no such column. A key is that of a common column: "time_ps".
  const std::vector<double>& column(const LogColumn& column) const;
  const std::vector<double>& column(std::string_view key) const { return column(common_column(key)); }
  bool has(std::string_view key) const;  // and one of its cells is not empty

  // Appends the rows of the run's next segment. Its first row is left out if it is the last row here. Its
  // times go on where this log ends if they begin again. Throws InputError if its columns differ.
  void append(const RunLog& next);
};

// Reads FOLDER/log.csv. A last line that is cut off in writing is left out. Throws InputError.
RunLog read_log(const std::filesystem::path& folder);

}  // namespace taut
