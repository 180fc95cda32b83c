#pragma once

#include <string>
#include <vector>

#include "studies/crosscheck.hpp"

namespace taut {

enum class Finding {
  kAgrees,   // within what was asked
  kParts,    // agrees, then chaos or its own residual takes it elsewhere
  kDiffers,  // in something that should have agreed
  kFailed,   // did not get to the end
  kAlone,    // got there, but what it was to be held against did not
};

struct Verdict {
  std::string who;
  Finding finding;
  std::string why;  // a sentence or two
};
std::string_view name_of(Finding finding);

// A line for each run that broke, beside which nothing is judged. Then one each on the start, OpenMM's own ways, every
// method, and the averages where there are any.
std::vector<Verdict> verdicts(const Crosscheck& c);

// Whether taut agrees with OpenMM, in a sentence: of the first method, and what parts it from OpenMM's run.
std::string headline(const Crosscheck& c);

// Mean square of the differences of two g(r) in units of their errors, over bins where either is known.
double chi_squared(const Distances& a, const Distances& b);

}  // namespace taut
