#pragma once

#include <string>
#include <vector>

#include "studies/ledger.hpp"

namespace taut {

// A time measured many times over, on a machine that does other things too.
struct Quartiles {
  double low = 0, median = 0, high = 0;
};
Quartiles quartiles(std::vector<double> values);

// How the ledger names a repeat of a point.
std::string repeat_name(const std::string& point, int repeat);

// Repeats of many points, all points once before any is run again, so that all meet the same machine. What
// failed once is not run again.
std::vector<Job> interleaved(const std::vector<Job>& points, int repeats, const Ledger& ledger);

// `figure` of a point's trials, over its repeats that did not fail.
Quartiles over_repeats(const std::string& point, int repeats, const Ledger& ledger, double Trial::*figure);

}  // namespace taut
