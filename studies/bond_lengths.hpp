#pragma once

#include <string>
#include <vector>

#include "studies/crosscheck.hpp"

namespace taut {

// The bond lengths of a run beside others: their error, whether it drifts, and what it is made of. A fifth of the run is
// left out at its start.
struct BondLengths {
  std::string run;      // its track, and OpenMM's algorithm where the run has both
  Estimate rms;         // relative error of a bond
  double largest = 0;   // of all bonds of the run
  Estimate slope;       // of the rms error of a sample in time [1/ns]; error 0: too few samples to tell
  double in_a_ns = 0;   // at most this far from now, by the slope and two of its errors
  std::string made_of;  // "lengths rounded to float"
  // In a run long enough for averages: a slope of more than four of its errors, and in a nanosecond of more than the
  // error itself. Shorter runs do not tell a drift from a slow swing.
  bool drifts = false;
};

// Of every run that got to its end, OpenMM's by algorithm.
std::vector<BondLengths> bond_lengths(const Crosscheck& c);

// taut's beside OpenMM's, and what chaos has to do with it, in a sentence or two.
std::string bond_lengths_in_words(const Crosscheck& c);

}  // namespace taut
