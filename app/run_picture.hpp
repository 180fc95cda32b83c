#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "pictures.hpp"

namespace taut {

inline constexpr long kMostFramesDrawn = 2000;

// Draws the runs in these folders over each other, from their logs: OUT/run.csv, its picture and report.html.
// Prints a coarse line for each curve, and what is measured of each run. Throws InputError where a folder holds no
// run, and where `out` holds pictures, unless `overwrite` is set.
struct PlotRequest {
  std::vector<std::filesystem::path> runs;
  std::filesystem::path out;
  std::string command;  // that the report names
  PictureOptions pictures = {};
  std::vector<std::string> panels = {};  // parts of the titles of those that are drawn; empty: all
  bool overwrite = false;
  long most_frames = kMostFramesDrawn;  // read of each trajectory, evenly spaced; 0: all
};
nlohmann::ordered_json plot_runs(const PlotRequest& request);  // the range of each curve, what was measured

}  // namespace taut
