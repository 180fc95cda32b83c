#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/simulation.hpp"

namespace taut {

// A column of the log, in its one home: log.csv and its readers, the terminal, what `taut measure` and `taut plot` take
// of a run, and Python's sim.log, taut.Row and taut.CSV go over the columns below. To add one is to add a line.
struct LogColumn {
  enum class Use { kNone, kDrawn, kMean, kMeanWhereItVaries };  // by `taut plot`, and by `taut measure` too
  struct OnTerminal {
    const char* heading = nullptr;  // null: not there
    int width = 0;
    const char* format = "";
  };

  std::string title, key;   // in log.csv "Temperature (K)", in JSON and Python "temperature_k"
  std::string words, unit;  // "temperature", "K"
  std::function<double(const Record&)> of;  // NaN where the run has none
  OnTerminal terminal = {};
  Use use = Use::kNone;
  bool of_box = false;  // a system without a box has none
};

// The columns that every run may have, in their order in log.csv.
const std::vector<LogColumn>& common_columns();
// That of a key. Throws std::out_of_range.
const LogColumn& common_column(std::string_view key);
// Those of a scene: the common ones, and those of its walls, steered atoms, pulls that change in time, moving anchors,
// biases and bonds of run.tension_of.
std::vector<LogColumn> log_columns(const Scene& scene);
// Those that log.csv has of a scene, and its first line.
std::vector<LogColumn> columns_of_file(const Scene& scene);
std::string header_of(const std::vector<LogColumn>& columns);
// A row: every number as short as it can be read back to the last bit, nothing where there is none.
std::string row_of(const std::vector<LogColumn>& columns, const Record& record);

// Of a bias: its variable, and the force along it.
std::array<LogColumn, 2> columns_of(const Bias& bias, std::size_t number);
// Of the bonds of run.tension_of: their mean tension, and its metric weight (simulation/held_bonds.hpp).
std::array<LogColumn, 2> columns_of_held(const RunSettings& run);

}  // namespace taut
