#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "report.hpp"

namespace taut {

// Measures runs as `taut measure --from auto` does, prints their figures and adds them to a page with their pictures,
// in which several runs are laid over each other. A run whose checkpoint is not there is left out; one that cannot be
// measured gets a note. At most most_frames of each trajectory are read, evenly spaced; 0: all. Returns the figures of each run.
nlohmann::ordered_json show_measured(const std::vector<std::filesystem::path>& runs,
                                     const std::vector<std::string>& names, StudyFiles& files,
                                     ReportPage& page, long most_frames);

}  // namespace taut
