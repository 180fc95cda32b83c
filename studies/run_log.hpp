#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace taut {

// The rows of a run's log.csv, column by column.
struct RunLog {
  std::vector<std::string> columns;         // "Time (ps)", "Temperature (K)", ...
  std::vector<std::vector<double>> values;  // of each column; NaN for an empty cell

  std::size_t rows() const { return values.empty() ? 0 : values[0].size(); }
  bool has(std::string_view column) const;  // and one of its cells is not empty
  // Returns an empty list if the log has no such column.
  const std::vector<double>& column(std::string_view name) const;
  double interval() const;  // time between rows [ps]; 0 for fewer than two

  // Appends the rows of the run's next segment. Its first row is left out if it is the last row here. Its
  // times go on where this log ends if they begin again. Throws InputError if its columns differ.
  void append(const RunLog& next);
};

inline constexpr std::string_view kLogTime = "Time (ps)", kLogPotential = "Potential Energy (kJ/mole)",
                                  kLogTotal = "Total Energy (kJ/mole)", kLogTemperature = "Temperature (K)",
                                  kLogBondError = "RMS Relative Bond Error", kLogPressure = "Pressure (bar)",
                                  kLogConstraintWork = "Constraint Work (kJ/mole)",
                                  kLogHeat = "Heat (kJ/mole)", kLogVolume = "Box Volume (nm^3)",
                                  kLogDensity = "Density (kg/m^3)", kLogBath = "Bath Temperature (K)";

// Reads FOLDER/log.csv. A last line that is cut off in writing is left out. Throws InputError.
RunLog read_log(const std::filesystem::path& folder);

}  // namespace taut
