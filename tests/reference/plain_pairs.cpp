#include "plain_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "md/units.hpp"
#include "plain_spline.hpp"

namespace taut::tests {
namespace {

// What follows gives E and −r dE/dr.

std::pair<double, double> lennard_jones(double sigma, double epsilon, double r) {
  const double s2 = sigma * sigma / (r * r), s6 = s2 * s2 * s2;
  return {4 * epsilon * (s6 - 1) * s6, 4 * epsilon * (12 * s6 - 6) * s6};
}

std::pair<double, double> of_table(const LennardJonesTable& table, int i, int j, double r) {
  const double a = table.a(table.type[i], table.type[j]) / std::pow(r, 12),
               b = table.b(table.type[i], table.type[j]) / std::pow(r, 6);
  return {a - b, 12 * a - 6 * b};
}

// (E S, −r (E' S + E S')), S = 1 − 10u³ + 15u⁴ − 6u⁵, S' = −30 u²(1 − u)²/w, u = (r − rs)/w, w = rc − rs
std::pair<double, double> switched(std::pair<double, double> pair, double r, double rs, double rc) {
  if (r <= rs) return pair;
  const double w = rc - rs, u = (r - rs) / w, S = 1 - u * u * u * (10 - 15 * u + 6 * u * u);
  return {pair.first * S, pair.second * S + pair.first * r * 30 * u * u * (1 - u) * (1 - u) / w};
}

// k q q' (1/r + k_rf r² − c_rf); without a cutoff k q q'/r
std::pair<double, double> coulomb(const Nonbonded& nb, double qq, double r) {
  const double rc = nb.cutoff.value_or(HUGE_VAL), over = 1 / nb.rf_dielectric,
               k = kCoulomb / nb.dielectric * qq;
  const double k_rf = (1 - over) / ((2 + over) * rc * rc * rc), c_rf = 3 / ((2 + over) * rc);
  return {k * (1 / r + k_rf * r * r - c_rf), k * (1 / r - 2 * k_rf * r * r)};
}

}  // namespace

PairSums plain_pairs(const Nonbonded& nb, const Box& box, const Vectors& x) {
  PairSums sum(x.cols());
  std::set<std::pair<int, int>> excluded;
  for (const auto& e : nb.exceptions) excluded.insert(std::minmax(e.i, e.j));
  const double rc = nb.cutoff.value_or(HUGE_VAL);
  for (int i = 0; i < x.cols(); ++i)
    for (int j = i + 1; j < x.cols(); ++j) {
      Vec3 d = x.col(i) - x.col(j);
      if (nb.cutoff) d = box.nearest_image(d);
      const double r = d.norm();
      if (std::abs(r * r / (rc * rc) - 1) < 2e-6) sum.clear[i] = sum.clear[j] = 0;
      if (r > rc || excluded.contains({i, j})) continue;
      const double rs = nb.switch_distance.value_or(rc);
      if (nb.lj_table)
        sum.add(i, j, d, switched(of_table(*nb.lj_table, i, j, r), r, rs, rc));
      else if (nb.epsilon[i] * nb.epsilon[j] != 0)
        sum.add(i, j, d,
                switched(lennard_jones((nb.sigma[i] + nb.sigma[j]) / 2,
                                       std::sqrt(nb.epsilon[i] * nb.epsilon[j]), r),
                         r, rs, rc));
      if (nb.charge[i] * nb.charge[j] != 0) sum.add(i, j, d, coulomb(nb, nb.charge[i] * nb.charge[j], r));
    }
  return sum;
}

PairSums plain_nonbonded(const Nonbonded& nb, const Box& box, const Vectors& x) {
  PairSums sum = plain_pairs(nb, box, x);
  for (const auto& [i, j, qq, sigma, epsilon] : nb.exceptions) {
    const Vec3 d = x.col(i) - x.col(j);
    sum.add(i, j, d, lennard_jones(sigma, epsilon, d.norm()));
    sum.add(i, j, d, {kCoulomb * qq / d.norm(), kCoulomb * qq / d.norm()});
  }
  return sum;
}

PairSums plain_wca(const Wca& wca, const Box& box, const Vectors& x) {
  PairSums sum(x.cols());
  std::set<std::pair<int, int>> excluded;
  for (const auto& [i, j] : wca.exclusions) excluded.insert(std::minmax(i, j));
  for (int i = 0; i < x.cols(); ++i)
    for (int j = i + 1; j < x.cols(); ++j) {
      const Vec3 d = box.nearest_image(x.col(i) - x.col(j));
      if (d.norm() >= std::pow(2, 1.0 / 6) * wca.sigma || excluded.contains({i, j})) continue;
      auto pair = lennard_jones(wca.sigma, wca.epsilon, d.norm());
      pair.first += wca.epsilon;
      sum.add(i, j, d, pair);
    }
  return sum;
}

PairSums plain_pairs(const TabulatedPairs& pairs, const Box& box, const Vectors& x) {
  PairSums sums(x.cols());
  std::set<std::pair<int, int>> excluded;
  for (const auto& [i, j] : pairs.exclusions) excluded.insert(std::minmax(i, j));
  for (const auto& [one, two, energy] : pairs.potentials) {
    const PlainSpline spline(*energy);
    for (int i = 0; i < x.cols(); ++i)
      for (int j = i + 1; j < x.cols(); ++j) {
        if (std::minmax(pairs.kind[i], pairs.kind[j]) != std::minmax(one, two) || excluded.contains({i, j}))
          continue;
        Vec3 d = x.col(i) - x.col(j);
        if (box.periodic()) d = box.nearest_image(d);
        if (const double r = d.norm(); r <= energy->last())
          sums.add(i, j, d, {spline.value(r), -r * spline.slope(r)});
      }
  }
  return sums;
}

}  // namespace taut::tests
