#include "base/zero_step.hpp"

#include <algorithm>
#include <cmath>

namespace taut {
namespace {

// P(χ² ≥ x) of n degrees of freedom, by Q_n = Q_{n−2} + (x/2)^{n/2−1} e^{−x/2}/Γ(n/2).
double chance_of(double x, int n) {
  double chance = n % 2 == 1 ? std::erfc(std::sqrt(x / 2)) : 0;
  for (int k = n % 2 == 1 ? 3 : 2; k <= n; k += 2)
    chance += std::exp((0.5 * k - 1) * std::log(std::max(x, 1e-300) / 2) - x / 2 - std::lgamma(0.5 * k));
  return n == 0 ? 1 : chance;
}

}  // namespace

std::optional<ZeroStep> at_zero_step(std::span<const AtStep> points) {
  double weights = 0, h2 = 0, y = 0;
  for (const auto& [h, mean] : points) {
    if (!(mean.error > 0) || !std::isfinite(mean.value)) return {};
    const double weight = 1 / (mean.error * mean.error);
    weights += weight, h2 += weight * h * h, y += weight * mean.value;
  }
  h2 /= weights, y /= weights;
  double spread = 0, together = 0;
  for (const auto& [h, mean] : points) {
    const double off = (h * h - h2) / mean.error;
    spread += off * off;
    together += off * mean.value / mean.error;
  }
  const bool one_length = std::ranges::all_of(points, [&](const AtStep& p) { return p.h == points[0].h; });
  if (points.empty() || one_length) return {};
  ZeroStep found;
  found.slope = {together / spread, 1 / std::sqrt(spread)};
  found.value = {y - found.slope.value * h2, std::sqrt(1 / weights + h2 * h2 / spread)};
  for (const auto& [h, mean] : points)
    found.chi_square +=
        std::pow((mean.value - found.value.value - found.slope.value * h * h) / mean.error, 2);
  found.free = static_cast<int>(points.size()) - 2;
  found.chance = chance_of(found.chi_square, found.free);
  return found;
}

}  // namespace taut
