#include "forcefield/dispersion.hpp"

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace taut {

// With x = (r − rs)/(rc − rs), 1 − S = 10x³ − 15x⁴ + 6x⁵. In t = r/rs and with a = rs/(rc − rs),
// xᵏ = aᵏ(t − 1)ᵏ, which the binomial theorem turns into powers of t, each integrated by itself:
//     ∫ tᵖ dt = (tᵖ⁺¹ − 1)/(p + 1),   ln t for p = −1.
// The powers cancel to about a⁵ of their size, hence long double.
double switch_integral(double rs, double rc, int n) {
  constexpr std::array<int, 3> kSwitch = {10, -15, 6};  // of x³, x⁴, x⁵
  const long double a = rs / (static_cast<long double>(rc) - rs), t = 1 + 1 / a;
  long double sum = 0;
  for (int k = 3; k <= 5; ++k) {
    long double binomial = 1, power_sum = 0;
    for (int m = 0; m <= k; ++m) {
      const int p = m - n;
      const long double integral = p == -1 ? std::log(t) : (std::pow(t, p + 1) - 1) / (p + 1);
      power_sum += ((k - m) % 2 ? -1 : 1) * binomial * integral;
      binomial = binomial * (k - m) / (m + 1);
    }
    sum += kSwitch[k - 3] * std::pow(a, k) * power_sum;
  }
  return static_cast<double>(sum) * std::pow(rs, 1 - n);
}

// E V = ½N² ⟨∫_rc^∞ U 4πr² dr + ∫_rs^rc (1 − S) U 4πr² dr⟩
//     = 8πN² ⟨ε(σ¹²(1/(9rc⁹) + K₁₀) − σ⁶(1/(3rc³) + K₄))⟩,   K_n = ∫_rs^rc (1 − S) r⁻ⁿ dr.
// OpenMM's convention: the mean is over all N(N+1)/2 pairs, an atom with itself included, excluded or not
// (Shirts et al. 2007, doi:10.1021/jp0735987, has the correction; the self pairs are OpenMM's).
double dispersion_coefficient(const Nonbonded& nb) {
  const double rc = *nb.cutoff;
  double tail12 = 1 / (9 * std::pow(rc, 9)), tail6 = 1 / (3 * std::pow(rc, 3));
  if (nb.switch_distance) {
    tail12 += switch_integral(*nb.switch_distance, rc, 10);
    tail6 += switch_integral(*nb.switch_distance, rc, 4);
  }

  std::map<std::pair<double, double>, double> classes;  // (σ, ε) -> how many atoms
  for (Eigen::Index i = 0; i < nb.sigma.size(); ++i) ++classes[{nb.sigma[i], nb.epsilon[i]}];

  double sum = 0;
  for (auto a = classes.begin(); a != classes.end(); ++a)
    for (auto b = classes.begin(); b != std::next(a); ++b) {
      const double pairs = a == b ? a->second * (a->second + 1) / 2 : a->second * b->second;
      const double sigma6 = std::pow((a->first.first + b->first.first) / 2, 6);
      const double epsilon = std::sqrt(a->first.second * b->first.second);
      sum += pairs * epsilon * sigma6 * (sigma6 * tail12 - tail6);
    }
  const double n = double(nb.sigma.size());
  return n > 0 ? 8 * std::numbers::pi * n * n * sum / (n * (n + 1) / 2) : 0.0;
}

}  // namespace taut
