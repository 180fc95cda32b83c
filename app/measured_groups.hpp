#pragma once

#include <vector>

#include "measures/run_groups.hpp"
#include "measures/zero_steps.hpp"
#include "pictures.hpp"

namespace taut {

// Groups of runs, and what those that differ by their step come to at none: what `taut measure` and `taut scan` show.
struct MeasuredGroups {
  std::vector<RunGroup> groups;
  std::vector<ZeroSteps> zero_steps = at_zero_step(groups);

  void print(const Notes& notes) const;
  nlohmann::ordered_json json() const;  // a list
  void draw(StudyFiles& files) const;
};

}  // namespace taut
