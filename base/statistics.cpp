#include "base/statistics.hpp"

#include <algorithm>
#include <cmath>

#include "base/series.hpp"

namespace taut {

void Slope::add(double t, double y, double weight) {  // Welford's updates, weighted as by West
  n_ += weight;
  const double dt = t - t_, dy = y - y_;
  t_ += weight * dt / n_;
  y_ += weight * dy / n_;
  tt_ += weight * dt * (t - t_);
  ty_ += weight * dt * (y - y_);
  yy_ += weight * dy * (y - y_);
}

double Slope::value() const {
  return tt_ > 0 ? ty_ / tt_ : 0.0;
}

double Slope::standard_error() const {
  if (n_ < 3 || tt_ == 0) return 0;
  const double residual = std::max(0.0, yy_ - ty_ * ty_ / tt_);
  return std::sqrt(residual / (n_ - 2) / tt_);
}

namespace {

// The means over `blocks` stretches of equal length; what does not fill them is left out at the start.
std::vector<double> means(const std::vector<double>& y, int blocks) {
  const std::size_t count = static_cast<std::size_t>(blocks), length = y.size() / count;
  std::vector<double> means(count, 0.0);
  const std::size_t first = y.size() - count * length;
  for (std::size_t n = first; n < y.size(); ++n)
    means[(n - first) / length] += y[n] / static_cast<double>(length);
  return means;
}

double mean(const std::vector<double>& y) {
  double sum = 0;
  for (const double value : y) sum += value;
  return y.empty() ? 0.0 : sum / static_cast<double>(y.size());
}

// Of neighbours' differences, `step` apart on average.
double variance_of_differences(std::span<const double> means, double step) {
  double sum = 0;
  for (std::size_t b = 1; b < means.size(); ++b) {
    const double d = means[b] - means[b - 1] - step;
    sum += d * d;
  }
  return sum / (static_cast<double>(means.size()) - 2);
}

}  // namespace

Estimate block_mean(const std::vector<double>& y, int blocks) {
  if (y.size() < 2 * static_cast<std::size_t>(blocks)) return {mean(y), 0};
  const std::vector<double> m = means(y, blocks);
  const double middle = mean(m);
  double spread = 0;
  for (const double value : m) spread += (value - middle) * (value - middle);
  return {middle, std::sqrt(spread / (blocks * (blocks - 1.0)))};
}

Estimate block_slope(const std::vector<double>& t, const std::vector<double>& y, int blocks) {
  Slope slope;
  if (y.size() < 2 * static_cast<std::size_t>(blocks)) {
    for (std::size_t n = 0; n < y.size(); ++n) slope.add(t[n], y[n]);
    return {slope.value(), 0};
  }
  const std::vector<double> t_means = means(t, blocks), y_means = means(y, blocks);
  for (std::size_t b = 0; b < t_means.size(); ++b) slope.add(t_means[b], y_means[b]);
  return {slope.value(), slope.standard_error()};
}

void RunningMean::add(double y, long steps) {
  if (length_ == 0) length_ = steps;
  sum_ += static_cast<double>(steps) * y;
  steps_ += steps;
  while (steps > 0) {  // a number fills more than one block where its steps are more
    const long here = std::min(steps, length_ - in_open_);
    add_to_open(y, here);
    steps -= here;
  }
}

void RunningMean::add_to_open(double y, long steps) {
  open_ += static_cast<double>(steps) * y;
  in_open_ += steps;
  if (in_open_ < length_) return;
  blocks_[full_++] = open_ / static_cast<double>(length_);
  open_ = 0, in_open_ = 0;
  if (full_ < kMost) return;
  for (int b = 0; b < kMost / 2; ++b) blocks_[b] = 0.5 * (blocks_[2 * b] + blocks_[2 * b + 1]);
  full_ = kMost / 2;
  length_ *= 2;
}

Estimate RunningMean::estimate() const {
  if (steps_ == 0) return {};
  const double all = sum_ / static_cast<double>(steps_);
  if (full_ < 8) return {all, 0};
  return {all, mean_of_run(blocks()).error};
}

Estimate RunningMean::later_half() const {
  if (full_ < 4) return {};
  return correlated_mean(blocks().subspan(static_cast<std::size_t>(full_) / 2));
}

void RunningSlope::add(double t, double y, long steps) {
  if (means_.steps() == 0) first_ = t, first_steps_ = steps;
  last_ = t;
  line_.add(t, y, static_cast<double>(steps));
  means_.add(y, steps);
}

Estimate RunningSlope::estimate() const {
  const std::span<const double> fine = means_.blocks();
  const double slope = line_.value();
  if (fine.size() < 8) return {slope, 0};
  std::vector<double> coarse;
  for (std::size_t b = 1; b < fine.size(); b += 2) coarse.push_back(0.5 * (fine[b - 1] + fine[b]));
  const double time = last_ - first_;
  const double length =
      static_cast<double>(means_.block_length()) * time / static_cast<double>(means_.steps() - first_steps_);
  const double v = variance_of_differences(fine, slope * length);
  const double v2 = variance_of_differences(coarse, 2 * slope * length);
  const double walk = std::max(0.0, (2 * v2 - v) / (2 * length));
  const double noise = std::max(0.0, length * (2 * v - v2) / 3);
  return {slope, std::sqrt(1.2 * walk / time + 12 * noise / (time * time * time))};
}

double deviations(const Estimate& a, const Estimate& b) {
  const double error = std::sqrt(a.error * a.error + b.error * b.error);
  const double apart =
      std::abs(a.value - b.value);  // of what is no number it is none, and agrees with nothing
  return error == 0 && !std::isnan(apart) ? 0.0 : apart / error;
}

}  // namespace taut
