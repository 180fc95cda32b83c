#include "forcefield/ewald/screening.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/ewald/screening.cpp"
#include "base/simd_targets.hpp"
// after the targets: once a target
#include "base/lane_arithmetic-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

// Σ c_k t^k, several vectors at a time: one waits for itself.
constexpr int kVectors = 4;
template <class V>
HWY_INLINE void polynomial(const std::vector<double>& c, const V* t, double* out) {
  const hn::DFromV<V> d;
  V sum[kVectors];
#pragma GCC unroll 4
  for (int v = 0; v < kVectors; ++v) sum[v] = hn::Zero(d);
  for (std::size_t k = c.size(); k-- > 0;) {
    const double next = c[k];
#pragma GCC unroll 4
    for (int v = 0; v < kVectors; ++v) sum[v] = sum[v] * t[v] + next;
  }
#pragma GCC unroll 4
  for (int v = 0; v < kVectors; ++v) hn::StoreU(sum[v], d, out + v * hn::Lanes(d));
}

void screen_pairs(const Screening& s, ScreenedPairs& pairs) {
  const hn::CappedTag<double, kScreenedPairs / kVectors> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int l = 0; l < kScreenedPairs; l += kVectors * lanes) {
    hn::Vec<decltype(d)> t[kVectors];
#pragma GCC unroll 4
    for (int v = 0; v < kVectors; ++v) t[v] = hn::LoadU(d, pairs.r2 + l + v * lanes) * s.scale - 0.5;
    polynomial(s.energy, t, pairs.energy + l);
    polynomial(s.force, t, pairs.force + l);
  }
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {
HWY_EXPORT(screen_pairs);

namespace {

using Real = long double;
constexpr Real kPi = std::numbers::pi_v<Real>;

// H and G by their series, Σ (−s)ⁿ/n! 2/√π {1/(2n+1), 2/(2n+3)}, where s is small.
Real screened(Real s, int first) {
  if (s < 0.5L) {
    Real sum = 0, power = 2 / std::sqrt(kPi) * Real(first);
    for (int n = 0; n < 25; ++n, power *= -s / Real(n)) sum += power / Real(2 * n + 2 * first - 1);
    return sum;
  }
  const Real u = std::sqrt(s);
  return first == 1 ? std::erf(u) / u : (std::erf(u) - 2 * u / std::sqrt(kPi) * std::exp(-s)) / (s * u);
}

constexpr int kPoints = 96;
using Series = std::array<Real, kPoints>;

// cos(πn/2kPoints)
Real wave(int n) {
  static const auto kWaves = [] {
    std::array<Real, 4 * kPoints> waves;
    for (int m = 0; m < 4 * kPoints; ++m) waves[m] = std::cos(kPi * m / (2 * kPoints));
    return waves;
  }();
  return kWaves[n % (4 * kPoints)];
}

// f(t), −½ ≤ t ≤ ½, as Σ c_k T_k(2t).
Series interpolate(const auto& f) {
  Series c{};
  for (int p = 0; p < kPoints; ++p) {
    const Real value = f(wave(2 * p + 1) / 2);
    for (int k = 0; k < kPoints; ++k) c[k] += (k == 0 ? 1 : 2) * value * wave(k * (2 * p + 1)) / kPoints;
  }
  return c;
}

// The first of those terms as Σ c_k t^k: T₀ = 1, T₁ = 2t, T_{k+1} = 4t T_k − T_{k−1}.
Series powers(const Series& c, int terms) {
  Series sum{}, before{}, now{}, next{};
  now[0] = 1;
  for (int k = 0; k < terms; ++k) {
    for (int n = 0; n < terms; ++n) {
      sum[n] += c[k] * now[n];
      next[n] = (k == 0 ? 2 : 4) * (n > 0 ? now[n - 1] : 0) - before[n];
    }
    before = now;
    now = next;
  }
  return sum;
}

// f(scale r²) in intervals. Within the cutoff the nearest whole number is an interval.
Real centre(const ScreeningFit& fit, int interval) {
  return fit.intervals == 1 ? 0.5L : interval;
}

std::vector<double> polynomials(const auto& f, const ScreeningFit& fit) {
  std::vector<Series> intervals;
  for (int p = 0; p < fit.intervals; ++p)
    intervals.push_back(interpolate([&](Real t) { return f(centre(fit, p) + t); }));
  const Real largest = f(0);
  int terms = fit.terms;  // of the series, whose coefficients fall steadily
  const auto matters = [&](const Series& c) { return std::abs(c[terms]) > fit.error * largest; };
  while (terms + 2 < kPoints && std::any_of(intervals.begin(), intervals.end(), matters)) terms += 2;

  std::vector<double> numbers(std::size_t(terms) * fit.intervals);
  for (int p = 0; p < fit.intervals; ++p) {
    const Series c = powers(intervals[p], terms);
    for (int k = 0; k < terms; ++k) numbers[k * fit.intervals + p] = static_cast<double>(c[k]);
  }
  return numbers;
}

}  // namespace

Screening::Screening(double given_alpha, double cutoff, const ScreeningFit& fit)
    : alpha(given_alpha),
      scale((static_cast<double>(centre(fit, fit.intervals - 1)) + 0.4999) / (cutoff * cutoff)) {
  const Real a = alpha, squared = a * a / scale;
  energy = polynomials([&](Real u) { return a * screened(squared * u, 1); }, fit);
  force = polynomials([&](Real u) { return a * a * a * screened(squared * u, 2); }, fit);
}

// Further off than the polynomials go, by erf itself.
void screen(const Screening& s, ScreenedPairs& pairs) {
  HWY_DYNAMIC_DISPATCH(screen_pairs)(s, pairs);
  if (s.scale * *std::max_element(pairs.r2, pairs.r2 + kScreenedPairs) <= 1) return;
  for (int l = 0; l < kScreenedPairs; ++l) {
    const double r2 = pairs.r2[l], r = std::sqrt(r2), u = s.alpha * r;
    if (s.scale * r2 <= 1) continue;
    pairs.energy[l] = std::erf(u) / r;
    pairs.force[l] = (pairs.energy[l] - 2 * std::numbers::inv_sqrtpi * s.alpha * std::exp(-u * u)) / r2;
  }
}

}  // namespace taut
#endif
