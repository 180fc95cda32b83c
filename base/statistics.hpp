#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "base/archive.hpp"

namespace taut {

// The least-squares slope of y against t, which are added one point at a time, and its standard error for
// white noise and points of one weight (for correlated samples that error is too small).
class Slope {
 public:
  void add(double t, double y, double weight = 1);
  double value() const;
  double standard_error() const;
  void serialize(Archive& archive) { archive(n_, t_, y_, tt_, ty_, yy_); }

 private:
  double n_ = 0, t_ = 0, y_ = 0, tt_ = 0, ty_ = 0, yy_ = 0;  // weight, means, centred sums
};

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

// The mean of numbers that are added one at a time, in fixed memory: when all blocks are full, each two
// neighbours become one of twice the length. A number stands for the steps since the one before it, so that a mean is
// one in time where rows are unevenly spaced; blocks are of so many steps. The error comes from the 16 to 31 blocks of a long run, which may be
// correlated and may drift at the beginning (mean_of_run in base/series.hpp). Neighbouring blocks of a slow quantity
// are no more independent than its rows. It is 0 for fewer than 8 blocks.
class RunningMean {
 public:
  void add(double y, long steps = 1);
  Estimate estimate() const;
  Estimate later_half() const;  // of the later half of the full blocks; 0 ± 0 for fewer than 4 blocks
  std::span<const double> blocks() const { return {blocks_.data(), static_cast<std::size_t>(full_)}; }
  long block_length() const { return length_; }  // steps
  long steps() const { return steps_; }          // of all numbers
  void serialize(Archive& archive) {
    archive(blocks_, length_, full_, open_, sum_, in_open_, steps_);
    archive.demand(0 <= full_ && full_ < kMost && 0 <= in_open_ && in_open_ < std::max(1L, length_));
    archive.demand((full_ == 0 ? 0 : 1) <= length_ && length_ <= kMostSteps / 4 && 0 <= steps_ &&
                   steps_ <= kMostSteps / 2);  // there is room to go on
  }

 private:
  static constexpr int kMost = 32;
  static constexpr long kMostSteps = std::numeric_limits<long>::max();

  void add_to_open(double y, long steps);

  std::array<double, kMost> blocks_{};  // their means
  long length_ = 0;                     // of a block [steps]; at first those of the first number
  int full_ = 0;                        // how many there are
  // Σ number × its steps, and Σ steps: of the last block, which is not full, and of the whole run.
  double open_ = 0, sum_ = 0;
  long in_open_ = 0, steps_ = 0;
};

// The least-squares slope s of a series, added one point at a time, in fixed memory, each weighing as the steps since the
// one before it. The series is
//     y(t) = y₀ + st + W(t) + ξ(t),
// with a random walk W of ⟨W²⟩ = Dt (the errors of all steps add up to one in a run's energy) and noise ξ
// whose correlations are short beside a block, c = ∫⟨ξ(0)ξ(t)⟩dt. Means over neighbouring blocks of length L
// then differ by sL on average, with the variance V(L) = ⅔DL + 2c/L. The variances for L and for 2L give D
// and c,
//     D = (2V(2L) − V(L))/2L,   c = L(2V(L) − V(2L))/3,
// and the slope over a time T has the variance (6/5)D/T + 12c/T³. The error is 0 for fewer than 8 blocks.
class RunningSlope {
 public:
  void add(double t, double y, long steps = 1);
  double value() const { return line_.value(); }
  Estimate estimate() const;
  void serialize(Archive& archive) { archive(line_, means_, first_, last_, first_steps_); }

 private:
  Slope line_;
  RunningMean means_;
  double first_ = 0, last_ = 0;  // t
  long first_steps_ = 0;         // of the first point, which are before its time
};

// |a − b| in units of their combined standard error; 0 where that is unknown.
double deviations(const Estimate& a, const Estimate& b);

}  // namespace taut
