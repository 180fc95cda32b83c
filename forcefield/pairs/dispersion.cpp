#include "forcefield/pairs/dispersion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace taut {

namespace {

// ∫_0^1 g(u) du in `panels` equal panels, by Gauss and Legendre's five points in each.
template <class Function>
double integrate(const Function& g, int panels) {
  constexpr std::array<double, 3> kPlace = {0, 0.5384693101056831, 0.9061798459386640};
  constexpr std::array<double, 3> kWeight = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  const double half = 0.5 / panels;
  double sum = 0;
  for (int p = 0; p < panels; ++p) {
    const double middle = (2 * p + 1) * half;
    sum += kWeight[0] * g(middle);
    for (int k = 1; k < 3; ++k)
      sum += kWeight[k] * (g(middle - kPlace[k] * half) + g(middle + kPlace[k] * half));
  }
  return half * sum;
}

}  // namespace

// By parts, a switch is a cutoff spread over its interval by the weight −S' = 30x²(1 − x)²/w, w = rc − rs:
//     ∫ (1 − S) r⁻ⁿ dr = ∫_rs^rc −S'(r) r¹⁻ⁿ/(n − 1) dr.
// In u, r = rs eᴸᵘ with L = ln(rc/rs), the powers of r are smooth however far apart rs and rc are, and
// x = (eᴸᵘ − 1)/(eᴸ − 1) is exact however near.
double cut_tail(double rs, double rc, int n) {
  const double w = rc - rs, L = std::log1p(w / rs);
  if (!(L > 0)) return std::pow(rc, 1 - n) / (n - 1);
  const auto weighted = [&](double u) {
    const double x = std::expm1(L * u) * rs / w, r = rs * std::exp(L * u);
    return 30 * x * x * (1 - x) * (1 - x) * L * (r / w) * std::pow(r, 1 - n);
  };
  return integrate(weighted, static_cast<int>(std::ceil(std::min(L, 1e3) / 0.05))) / (n - 1);
}

namespace {

// ε(σ¹² tail12 − σ⁶ tail6) of all pairs, where 4εσ¹² = a and 4εσ⁶ = b.
double mean_of_types(const LennardJonesTable& table, double tail12, double tail6) {
  Eigen::VectorXd atoms = Eigen::VectorXd::Zero(table.a.rows());
  for (const int type : table.type) ++atoms[type];
  const Eigen::MatrixXd u = (table.a * tail12 - table.b * tail6) / 4;
  return (atoms.dot(u * atoms) + atoms.dot(u.diagonal())) / 2;
}

// 8πN² ⟨ε(σ¹² tail12 − σ⁶ tail6)⟩
double over_pairs(const Nonbonded& nb, double tail12, double tail6) {
  const double n = double(nb.sigma.size());
  const double scale = n > 0 ? 8 * std::numbers::pi * n * n / (n * (n + 1) / 2) : 0.0;
  if (nb.lj_table) return scale * mean_of_types(*nb.lj_table, tail12, tail6);

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
  return scale * sum;
}

}  // namespace

// E V = ½N² ⟨∫ (1 − S) U 4πr² dr⟩ = 8πN² ⟨ε(σ¹² K₁₀ − σ⁶ K₄)⟩,   K_n = ∫ (1 − S) r⁻ⁿ dr.
// OpenMM's convention: the mean is over all N(N+1)/2 pairs, an atom with itself included, excluded or not
// (Shirts et al. 2007, doi:10.1021/jp0735987, has the correction; the self pairs are OpenMM's).
double dispersion_coefficient(const Nonbonded& nb) {
  const double rc = *nb.cutoff, rs = nb.switch_distance.value_or(rc);
  return over_pairs(nb, cut_tail(rs, rc, 10), cut_tail(rs, rc, 4));
}

// ⅓Ξ V = −½N² ⟨∫ r d((1 − S) U)/dr 4πr² dr⟩/3 = E V + ½N² ⟨4π r_c³ U(r_c)⟩/3, the last where there is no
// switch (Frenkel and Smit, Understanding Molecular Simulation, 3.2.2).
double dispersion_virial_coefficient(const Nonbonded& nb) {
  const double energy = dispersion_coefficient(nb), rc = *nb.cutoff;
  if (nb.switch_distance.value_or(rc) < rc) return energy;
  return energy + over_pairs(nb, std::pow(rc, -9) / 3, std::pow(rc, -3) / 3);
}

}  // namespace taut
