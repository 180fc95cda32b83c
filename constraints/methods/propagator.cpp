#include "constraints/methods/propagator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/nearest_name.hpp"

namespace taut {

std::string_view name_of(Damping damping) {
  switch (damping) {
    case Damping::kDiscrete:
      return "discrete";
    case Damping::kCentred:
      return "centred";
    case Damping::kImplicit:
      return "implicit";
    case Damping::kLagged:
      break;
  }
  return "lagged";
}

std::vector<std::string_view> damping_names() {
  std::vector<std::string_view> names;
  for (const Damping damping : kDampings) names.push_back(name_of(damping));
  return names;
}

Damping damping_named(std::string_view name) {
  expect_name("method.damping", name, damping_names());
  return *std::ranges::find(kDampings, name, name_of);
}

Propagator::Propagator(double ah, double bh, Damping damping) : from_rest(1 - 0.5 * bh * bh) {
  if (damping == Damping::kLagged) {
    trace = 2 - 2 * ah - bh * bh;
    determinant = 1 - 2 * ah;
  } else {
    trace = (2 - bh * bh) / (1 + ah);
    determinant = (1 - ah) / (1 + ah);
  }
}

std::array<std::complex<double>, 2> Propagator::roots() const {
  const double half = 0.5 * trace;
  const std::complex<double> spread = std::sqrt(std::complex<double>(half * half - determinant));
  const auto larger = half < 0 ? half - spread : half + spread;
  const auto smaller = half < 0 ? half + spread : half - spread;
  return {larger, smaller};
}

// σ_n = σ_1 U_n − det σ_0 U_{n−1}, U_n = (z₁ⁿ − z₂ⁿ)/(z₁ − z₂), n zⁿ⁻¹ where the roots meet.
double Propagator::residual(double sigma_0, double sigma_1, int n) const {
  if (n == 0) return sigma_0;
  const auto [z1, z2] = roots();
  const auto u = [&, z1 = z1, z2 = z2](int power) {
    if (power == 0) return 0.0;
    if (std::abs(z1 - z2) < 1e-7) return power * std::pow(0.5 * trace, power - 1);
    return ((std::pow(z1, power) - std::pow(z2, power)) / (z1 - z2)).real();
  };
  return sigma_1 * u(n) - determinant * sigma_0 * u(n - 1);
}

double Propagator::most_of_a_feed() const {
  if (!stable()) return HUGE_VAL;
  double sum = 0, sigma = 1, before = 0;
  for (int n = 0; n < 100000 && std::abs(sigma) + std::abs(before) > 1e-3; ++n) {
    sum += std::abs(sigma);
    before = std::exchange(sigma, next(sigma, before));
  }
  return sum;
}

double stability_limit(double ah, Damping damping) {
  if (!(ah >= 0)) return 0;
  if (damping != Damping::kLagged) return 2;
  return ah < 1 ? 2 * std::sqrt(1 - ah) : 0.0;
}

DimensionlessGains gains_for_decay(double r, Damping damping) {
  if (damping == Damping::kLagged) return {0.5, std::sqrt(1 - r)};
  return {1, std::sqrt(2 * (1 - r))};
}

DimensionlessGains gains_for_root(double r, Damping damping) {
  const double q = 1 + r * r;
  if (damping == Damping::kLagged) return {(1 - r * r) / 2, 1 - r};
  return {(1 - r * r) / q, std::sqrt(2 / q) * (1 - r)};
}

DimensionlessGains gains_for_sweeps(double t, Damping damping) {
  const double q = 1 + t * t;
  if (damping == Damping::kLagged) return {(1 - t * t) / 2, std::sqrt(1 - t)};
  return {(1 - t * t) / q, std::sqrt(2 - 2 * t * (1 + t) / q)};
}

// The coefficients of |a|², v·a and |v|² in the formulas that stand beside Drive.
Drive drive_of(double ah, double h, Damping damping) {
  const double h2 = h * h, quarter = 0.25 * h2 * h2;
  switch (damping) {
    case Damping::kDiscrete:
      return {};
    case Damping::kCentred:
      return {.square_a = quarter / (1 + ah)};
    case Damping::kImplicit:
      return {.square_a = quarter * (1 + 2 * ah) / (1 + ah), .cross = ah * h2 * h / (1 + ah)};
    case Damping::kLagged:
      break;
  }
  return {.square_a = quarter, .square_v = -ah * h2};
}

}  // namespace taut
