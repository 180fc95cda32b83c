#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "measures/measured_run.hpp"
#include "report.hpp"

namespace taut {

void print_run(const MeasuredRun& run);  // what was measured, and the run's own doubts

// Measures runs as `taut measure --from auto` does and prints their figures. A run whose checkpoint is not there is left
// out; one that cannot be measured gets a note on the page. At most most_frames of each trajectory are read, evenly
// spaced; 0: all.
std::vector<std::optional<MeasuredRun>> measure_runs(const std::vector<std::filesystem::path>& runs,
                                                     ReportPage& page, long most_frames);

// Adds to a picture the tables of what was measured, in which several runs are laid over each other, and to the page
// these tables.
void add_measured(const std::vector<std::optional<MeasuredRun>>& runs, const std::vector<std::string>& names,
                  Picture& picture, ReportPage& page);

}  // namespace taut
