#include "forcefield/pme/screening.hpp"

#include <cmath>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/pme/screening.cpp"
#include "forcefield/clusters/simd_targets.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void screen_pairs(const Screening& s, ScreenedPairs& pairs) {
  using D = hn::CappedTag<double, kScreenedPairs>;
  const D d;
  for (int l = 0; l < kScreenedPairs; l += static_cast<int>(hn::MaxLanes(d))) {
    const auto t = hn::MulSub(hn::LoadU(d, pairs.r2 + l), hn::Set(d, s.scale), hn::Set(d, 1.0));
    auto energy = hn::Zero(d), force = energy;
    for (std::size_t k = s.energy.size(); k-- > 0;) energy = hn::MulAdd(energy, t, hn::Set(d, s.energy[k]));
    for (std::size_t k = s.force.size(); k-- > 0;) force = hn::MulAdd(force, t, hn::Set(d, s.force[k]));
    hn::StoreU(energy, d, pairs.energy + l);
    hn::StoreU(force, d, pairs.force + l);
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

// f(t), −1 ≤ t ≤ 1, as Σ c_k t^k.
template <class Function>
std::vector<double> polynomial(const Function& f, double error) {
  constexpr int kPoints = kMostScreeningTerms;
  std::vector<Real> chebyshev(kPoints);
  Real largest = 0;
  for (int p = 0; p < kPoints; ++p) {
    const auto wave = [p](int k) {
      return std::cos(kPi * (k * (2 * p + 1) % (4 * kPoints)) / (2 * kPoints));
    };
    const Real value = f(wave(1));
    largest = std::max(largest, std::abs(value));
    for (int k = 0; k < kPoints; ++k) chebyshev[k] += (k == 0 ? 1 : 2) * value * wave(k) / kPoints;
  }
  int terms = 2;  // they fall steadily
  while (terms < kPoints && std::abs(chebyshev[terms]) > error * largest) ++terms;
  terms += terms % 2;

  // T₀ = 1, T₁ = t, T_{k+1} = 2t T_k − T_{k−1}
  std::vector<Real> sum(terms), before(terms), now(terms), next(terms);
  now[0] = 1;
  for (int k = 0; k < terms; ++k) {
    for (int c = 0; c < terms; ++c) {
      sum[c] += chebyshev[k] * now[c];
      next[c] = (k == 0 ? 1 : 2) * (c > 0 ? now[c - 1] : 0) - before[c];
    }
    before = now;
    now = next;
  }
  return {sum.begin(), sum.end()};
}

}  // namespace

Screening::Screening(double given_alpha, double cutoff, double error)
    : alpha(given_alpha), scale(2 / (cutoff * cutoff)) {
  const Real a = alpha, s = a * a * cutoff * cutoff / 2;
  energy = polynomial([&](Real t) { return a * screened(s * (t + 1), 1); }, error);
  force = polynomial([&](Real t) { return a * a * a * screened(s * (t + 1), 2); }, error);
}

// Further off than the polynomials go, by erf itself.
void screen(const Screening& s, ScreenedPairs& pairs) {
  HWY_DYNAMIC_DISPATCH(screen_pairs)(s, pairs);
  for (int l = 0; l < kScreenedPairs; ++l) {
    const double r2 = pairs.r2[l], r = std::sqrt(r2), u = s.alpha * r;
    if (s.scale * r2 <= 2) continue;
    pairs.energy[l] = std::erf(u) / r;
    pairs.force[l] = (pairs.energy[l] - 2 * std::numbers::inv_sqrtpi * s.alpha * std::exp(-u * u)) / r2;
  }
}

}  // namespace taut
#endif
