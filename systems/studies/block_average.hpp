#pragma once

#include <array>
#include <vector>

#include "md/memory.hpp"

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

// The same, one number at a time and in fixed memory: when its blocks are full, two and two become one of
// twice the length. The error comes from the 16 to 31 that there are in a long run; 0 for fewer than 8.
class RunningMean {
 public:
  void add(double y);
  Estimate estimate() const;
  void remember(Memory& memory) {
    memory(blocks_, length_, full_, open_, sum_, in_open_, count_);
    memory.demand(0 <= full_ && full_ < kMost && 0 <= in_open_ && in_open_ < length_);
    memory.demand(length_ <= kLongest && 0 <= count_ && count_ <= kLongest);
  }

 private:
  static constexpr int kMost = 32;
  static constexpr long kLongest = 1L << 56;  // more samples than anybody takes

  std::array<double, kMost> blocks_{};  // their means
  long length_ = 1;                     // of a block
  int full_ = 0;                        // how many there are
  double open_ = 0, sum_ = 0;           // of the block that is not full, of all
  long in_open_ = 0, count_ = 0;
};

// |a − b| in units of their common standard error; 0 where that is not known.
double deviations(const Estimate& a, const Estimate& b);

}  // namespace taut
