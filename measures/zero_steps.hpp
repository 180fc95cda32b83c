#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "base/zero_step.hpp"
#include "measures/run_groups.hpp"

namespace taut {

inline constexpr const char* kZeroSteps = "zero_step.csv";

// The figures of groups that differ by their step alone, extrapolated to none.
struct ZeroSteps {
  struct OfFigure {
    Figure figure;  // its value at zero step
    ZeroStep fit;
  };
  ScanValues values;  // of the other keys that the scan varies
  std::string steps;  // "2, 4, 5"
  std::vector<OfFigure> figures;

  std::string label() const;  // "method.name=newton at zero step"
};

// For each setting of the other keys, in the groups' order; none where run.dt_fs has fewer than two values.
std::vector<ZeroSteps> at_zero_step(const std::vector<RunGroup>& groups);

std::string in_words(const ZeroSteps& of, int width);
nlohmann::ordered_json json_of(const ZeroSteps& of);
// figure, unit, curve (the other keys' values), value, error, slope in fs², its error, χ², its degrees of freedom, chance.
std::string zero_steps_csv(const std::vector<ZeroSteps>& all);

}  // namespace taut
