#pragma once

#include <vector>

#include "measures/mean_forces_of_scan.hpp"
#include "measures/run_groups.hpp"
#include "measures/zero_steps.hpp"
#include "pictures.hpp"

namespace taut {

// Groups of runs, what those that differ by their step come to at none, and those that differ by the length of a bond whose
// tension the log has: what `taut measure` and `taut scan` show.
struct MeasuredGroups {
  std::vector<RunGroup> groups;
  std::vector<ZeroSteps> zero_steps = at_zero_step(groups);
  std::vector<MeanForces> forces = mean_forces(groups);

  void print(const Notes& notes) const;
  nlohmann::ordered_json json() const;  // a list
  void draw(StudyFiles& files) const;
};

void print_notes_of_groups(const Notes& notes);

// Returns what `measure` returns, and prints the notes that it took where it throws.
auto with_notes(const Notes& notes, auto&& measure) {
  try {
    return measure();
  } catch (...) {
    print_notes_of_groups(notes);
    throw;
  }
}

}  // namespace taut
