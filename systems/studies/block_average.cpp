#include "systems/studies/block_average.hpp"

#include <cmath>
#include <cstddef>

#include "md/observables.hpp"

namespace taut {
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

double deviations(const Estimate& a, const Estimate& b) {
  const double error = std::hypot(a.error, b.error);
  return error > 0 ? std::abs(a.value - b.value) / error : 0.0;
}

}  // namespace taut
