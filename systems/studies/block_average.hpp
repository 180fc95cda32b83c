#pragma once

#include <vector>

namespace taut {

// A value with its standard error, from blocks: means over a few long stretches of a run are all but
// independent where single samples are not (Flyvbjerg and Petersen 1989, doi:10.1063/1.457480).
struct Estimate {
  double value = 0;
  double error = 0;  // 0 where there are too few samples to tell
};

constexpr int kBlocks = 10;

// y̅ ± its standard error, from the spread of block means.
Estimate block_mean(const std::vector<double>& y, int blocks = kBlocks);

// Least-squares slope of y against t, through the blocks' means.
Estimate block_slope(const std::vector<double>& t, const std::vector<double>& y, int blocks = kBlocks);

// |a − b| in units of their common standard error; 0 where that is not known.
double deviations(const Estimate& a, const Estimate& b);

}  // namespace taut
