#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace taut {

// Samples of a run may be unevenly spaced: it was resumed with rows further apart, its segments have frames at other
// intervals, or its end got a row of its own. Means then weigh time, and correlations take samples that are even.

// Times that are in order, evenly spaced among those of a series.
struct EvenPart {
  std::vector<std::size_t> samples;  // their numbers in the series
  double interval = 0;               // from one to the next; 0 for fewer than two

  bool whole(std::span<const double> t) const { return samples.size() == t.size(); }
};

// The evenly spaced parts of ascending times, longest first, each of more samples than those before it; all samples
// where they are even. A part is a stretch, or every k-th sample where stretches are spaced by whole factors. One that
// is hardly longer than another of more samples is left out.
std::vector<EvenPart> even_parts(std::span<const double> t);

// Series at ascending times as even ones of the same mean in time: a sample stands for the time since the one before
// it, and each interval's mean is a sample of the even series. The interval is the spacing in which half of the time is
// spent at most. Where times are even already series stay as they are. Times that nothing is known of, longer than the
// spacing on both sides of them, are left out.
class EvenMeans {
 public:
  explicit EvenMeans(std::span<const double> t);

  std::vector<double> of(std::span<const double> y) const;
  // The number of the first sample that belongs to an interval from this one on.
  std::size_t first_sample(std::size_t interval) const;

 private:
  struct Share {
    std::size_t interval, sample;
    double time;  // of the interval that the sample stands for [intervals]
  };
  std::size_t samples_;
  std::size_t intervals_ = 0;
  std::vector<Share> shares_;  // in order; empty where times are even
};

// The time that each sample of a series stands for.
std::vector<double> spans_of(std::span<const double> t);

}  // namespace taut
