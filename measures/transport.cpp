#include "measures/transport.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/series.hpp"
#include "md/units.hpp"

namespace taut {
namespace {

constexpr double kResolved = 0.5;  // what is left of a correlation from one row to the next
constexpr double kMilliPascalSecond = kBarPerUnit * 1e-4;  // of one kJ/mol/nm³ · ps

// The five series whose correlations agree in an isotropic liquid, without their means [kJ/mol/nm³].
std::vector<std::vector<double>> shear_stresses(const std::array<std::vector<double>, 6>& p,
                                                const EvenPart& part) {
  std::vector<std::vector<double>> all(5);
  for (const std::size_t row : part.samples) {
    for (std::size_t k = 0; k < 3; ++k) all[k].push_back(p[k + 3][row]);
    all[3].push_back((p[0][row] - p[1][row]) / 2);
    all[4].push_back((p[1][row] - p[2][row]) / 2);
  }
  for (std::vector<double>& series : all) {
    double mean = 0;
    for (const double value : series) mean += value / static_cast<double>(series.size());
    for (double& value : series) value = (value - mean) / kBarPerUnit;
  }
  return all;
}

GreenKubo of_part(const StressSeries& stress, EvenPart part) {
  constexpr std::size_t kLeastRows = 1000, kMostLags = 2000;
  GreenKubo result;
  result.rows = std::move(part);
  const std::size_t rows = result.rows.samples.size();
  const double interval = result.rows.interval;
  if (rows < kLeastRows) {
    result.flaw = fmt::format("{} {} are too few, it takes {}", rows,
                              result.rows.whole(stress.t) ? "rows" : "evenly spaced rows", kLeastRows);
    return result;
  }
  const auto series = shear_stresses(stress.pressure, result.rows);
  const std::size_t lags = std::min(rows / 20, kMostLags), block = (rows - lags) / kBlocks;
  std::vector<std::vector<double>> c(lags, std::vector<double>(kBlocks, 0.0));  // of each lag and block
  for (std::size_t b = 0; b < kBlocks; ++b)
    for (std::size_t lag = 0; lag < lags; ++lag) {
      double sum = 0;
      for (const auto& p : series)
        for (std::size_t o = b * block; o < (b + 1) * block; ++o) sum += p[o] * p[o + lag];
      c[lag][b] = sum / static_cast<double>(block * series.size());
    }
  const double scale = stress.volume / (kBoltzmann * stress.temperature) * kMilliPascalSecond;
  const double at_zero = independent_mean(c[0]).value;
  if (at_zero <= 0) {
    result.flaw = "the pressure does not fluctuate";
    return result;
  }
  std::vector<std::vector<double>> integral(lags, std::vector<double>(kBlocks, 0.0));
  for (std::size_t lag = 0; lag < lags; ++lag) {
    for (std::size_t b = 0; b < kBlocks && lag > 0; ++b)
      integral[lag][b] = integral[lag - 1][b] + scale * interval * (c[lag - 1][b] + c[lag][b]) / 2;
    const Estimate mean = independent_mean(c[lag]);
    result.t.push_back(interval * static_cast<double>(lag));
    result.correlation.push_back({mean.value / at_zero, mean.error / at_zero});
    result.integral.push_back(independent_mean(integral[lag]));
  }
  if (result.correlation[1].value < kResolved) {
    result.flaw = fmt::format(
        "the rows are too far apart: the pressure's correlation falls to {:.2f} from one to the next, {:.4g} "
        "ps later; it takes a log of every few steps (run.log_every)",
        result.correlation[1].value, interval);
    return result;
  }
  // Stress oscillates, so that its integral may pause before it goes on: it has to stay flat up to 2t.
  std::size_t flat = 0;  // the first t/2 since which all were flat, in lags; 0: none
  for (std::size_t half = 1; 2 * half < lags; ++half) {
    std::vector<double> growth;
    for (std::size_t b = 0; b < kBlocks; ++b) growth.push_back(integral[2 * half][b] - integral[half][b]);
    const Estimate grown = independent_mean(growth);
    if (grown.value > grown.error)
      flat = 0;
    else if (flat == 0)
      flat = half;
    if (flat == 0 || half < 2 * flat) continue;
    result.cut = result.t[2 * flat];
    result.viscosity = result.integral[2 * flat];
    return result;
  }
  result.flaw =
      fmt::format("its integral still grows after {:.4g} ps: it takes a longer run", result.t.back());
  return result;
}

}  // namespace

GreenKubo green_kubo(const StressSeries& stress) {
  GreenKubo found;
  for (EvenPart& part : even_parts(stress.t)) {
    found = of_part(stress, std::move(part));
    if (found.correlation.size() > 1 && found.correlation[1].value >= kResolved) break;
  }
  return found;
}

double finite_size_correction(double temperature, double viscosity, double edge) {
  constexpr double kXi = 2.837297;
  const double eta = viscosity / kMilliPascalSecond;  // [kJ/mol ps/nm³]
  return kXi * kBoltzmann * temperature / (6 * std::numbers::pi * eta * edge);
}

}  // namespace taut
