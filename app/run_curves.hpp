#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/statistics.hpp"
#include "measures/run_log.hpp"
#include "systems/scene/scene.hpp"

namespace taut {

// One curve of a panel.
struct Curve {
  std::string panel, name;
  std::vector<double> t, y;           // [ps], [the panel's unit]
  bool running_mean = false;          // drawn beside it
  std::string key = {};               // of the column; empty: of none
  double from = 0;                    // where the measured part begins, which the mean is of [ps]
  std::optional<Estimate> mean = {};  // of that part
};

// What is drawn of a run in time: energies, temperature beside the bath's, pressure, volume, errors and tensions of bonds.
// run: the name of its curves; empty where it is drawn alone. scene: null where it is not known. Tensions come from at
// most most_frames of the trajectory, evenly spaced; 0: all.
std::vector<Curve> curves_of(const RunLog& log, const std::string& run, const Scene* scene,
                             const std::filesystem::path& folder, long most_frames);

}  // namespace taut
