#pragma once

#include <string>
#include <vector>

#include "base/statistics.hpp"

namespace taut {

// A measured number of a run.
struct Figure {
  std::string key;    // in JSON and CSV: "density_kg_m3"
  std::string words;  // on a terminal: "density"
  std::string unit;   // "kg/m³"
  Estimate value;
};

// The mean of an even series; without an error where its samples are too few to tell it.
Estimate mean_with_error(const std::vector<double>& y);

std::string with_error(const Estimate& e);  // "992.3 ± 1.8"; says so where there is no error
std::string figures_table(const std::vector<Figure>& figures);  // a line each

// The table of each run's figures: figure, unit, run and its number, value, error. Of a mean over runs the number is 0.
inline constexpr const char* kEachRunHeader = "figure,unit,run,number,value,standard_error\n";
std::string each_run_row(const Figure& figure, const std::string& run, long number);

// The mean of one figure over runs that differ by their seed. The error is the larger of two: what the runs'
// own errors come to, √(Σeᵢ²)/n, and what the spread of their means tells, s/√n.
struct OverSeeds {
  Figure figure;
  std::size_t runs = 0;
  double from_blocks = 0, from_seeds = 0;
};
std::vector<OverSeeds> over_seeds(const std::vector<std::vector<Figure>>& runs);

}  // namespace taut
