#include "base/series.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>
#include <vector>

namespace taut {
namespace {

double sample_mean(std::span<const double> y) {
  double sum = 0;
  for (const double value : y) sum += value;
  return y.empty() ? 0.0 : sum / static_cast<double>(y.size());
}

double variance_about(double mean, std::span<const double> y) {
  double sum = 0;
  for (const double value : y) sum += (value - mean) * (value - mean);
  return sum / static_cast<double>(y.size());
}

// A series that is constant but for rounding has no fluctuations to correlate.
bool is_constant(double variance, double mean) {
  constexpr double kRounding = 1e-13;
  return std::sqrt(variance) <= kRounding * std::abs(mean);
}

// Σᵢ (yᵢ − y̅)(yᵢ₊ₖ − y̅) of every lag k: the Fourier transform of the power spectrum (Wiener and Khinchin), of a series
// that zeros make twice as long.
std::vector<double> lagged_products(std::span<const double> y, double mean) {
  std::vector<double> off(2 * std::bit_ceil(y.size()), 0.0);
  for (std::size_t i = 0; i < y.size(); ++i) off[i] = y[i] - mean;
  Eigen::FFT<double> fourier;
  std::vector<std::complex<double>> spectrum;
  fourier.fwd(spectrum, off);
  for (std::complex<double>& part : spectrum) part = std::norm(part);
  fourier.inv(off, spectrum);
  return off;
}

// Of at least three independent samples.
double error_of_mean(std::span<const double> y) {
  const double independent = std::max(3.0, static_cast<double>(y.size()) / statistical_inefficiency(y));
  return std::sqrt(variance_about(sample_mean(y), y) / (independent - 1));
}

}  // namespace

double statistical_inefficiency(std::span<const double> y) {
  const std::size_t n = y.size();
  if (n < 3) return 1;
  const double mean = sample_mean(y), variance = variance_about(mean, y);
  if (is_constant(variance, mean)) return 1;
  const std::vector<double> products = lagged_products(y, mean);
  double g = 1;
  for (std::size_t k = 1; k < n - 1; ++k) {
    const double c = products[k] / (static_cast<double>(n - k) * variance);
    if (c <= 0) break;
    g += 2 * c * (1 - static_cast<double>(k) / static_cast<double>(n));
  }
  return g;
}

Estimate correlated_mean(std::span<const double> y) {
  const double mean = sample_mean(y);
  if (y.size() < 3) return {mean, 0};
  const double variance = variance_about(mean, y);
  const double independent = static_cast<double>(y.size()) / statistical_inefficiency(y);
  if (independent < 3 || is_constant(variance, mean)) return {mean, 0};
  return {mean, std::sqrt(variance / (independent - 1))};
}

bool has_trend(std::span<const double> y, double errors) {
  const double n = static_cast<double>(y.size()), times = n * (n * n - 1) / 12;  // Σ (k − k̅)²
  if (y.size() < 3) return false;
  Slope line;
  for (std::size_t k = 0; k < y.size(); ++k) line.add(static_cast<double>(k), y[k]);
  std::vector<double> off(y.begin(), y.end());  // from the line but for a constant
  for (std::size_t k = 0; k < y.size(); ++k) off[k] -= line.value() * static_cast<double>(k);
  return std::abs(line.value()) > errors * error_of_mean(off) * std::sqrt(n / times);
}

Estimate mean_of_run(std::span<const double> y) {
  constexpr double kSurely = 4;  // errors of the trend
  const double mean = sample_mean(y);
  if (y.size() < 3 || is_constant(variance_about(mean, y), mean)) return {mean, 0};
  const double halves_apart =
      std::abs(sample_mean(y.first(y.size() / 2)) - sample_mean(y.last(y.size() - y.size() / 2)));
  return {mean, std::max(error_of_mean(y), has_trend(y, kSurely) ? halves_apart : halves_apart / 2)};
}

std::size_t equilibration_end(std::span<const double> series) {
  constexpr std::size_t kTried = 100, kMost = 1000;
  const std::size_t bin = std::max<std::size_t>(1, series.size() / kMost);
  std::vector<double> y;
  for (std::size_t at = 0; at + bin <= series.size(); at += bin)
    y.push_back(sample_mean(series.subspan(at, bin)));
  const std::size_t last = y.size() - y.size() / 10;
  const std::size_t stride = std::max<std::size_t>(1, last / kTried);
  std::size_t best = 0;
  double most = 0;
  for (std::size_t t0 = 0; t0 < last; t0 += stride) {
    const auto rest = std::span<const double>(y).subspan(t0);
    const double independent = static_cast<double>(rest.size()) / statistical_inefficiency(rest);
    if (independent > most) most = independent, best = t0;
  }
  return best * bin;
}

Estimate independent_mean(std::span<const double> values) {
  const double n = static_cast<double>(values.size()), mean = sample_mean(values);
  if (n < 2) return {mean, 0};
  return {mean, std::sqrt(variance_about(mean, values) / (n - 1))};
}

}  // namespace taut
