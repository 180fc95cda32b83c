#include "measures/mean_force.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

namespace taut {
namespace {

// Row i: what each value weighs in the integral from the first place to the i-th. Gauss's two points integrate a cubic
// exactly.
Eigen::MatrixXd integral_weights(const std::vector<HeldLength>& at) {
  const int n = static_cast<int>(at.size()), stencil = std::min(n, 4);
  const auto x = [&](int k) { return at[static_cast<std::size_t>(k)].length; };
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i + 1 < n; ++i) {
    weights.row(i + 1) = weights.row(i);
    const int first = std::clamp(i - 1, 0, n - stencil);
    const double half = (x(i + 1) - x(i)) / 2, middle = (x(i + 1) + x(i)) / 2;
    for (const double side : {-1.0, 1.0}) {
      const double place = middle + side * half / std::sqrt(3.0);
      for (int k = first; k < first + stencil; ++k) {
        double lagrange = half;
        for (int l = first; l < first + stencil; ++l)
          if (l != k) lagrange *= (place - x(l)) / (x(k) - x(l));
        weights(i + 1, k) += lagrange;
      }
    }
  }
  return weights;
}

double relative(const Estimate& e) {
  return e.error / e.value;
}

}  // namespace

std::vector<FreeEnergies> integrate_mean_force(const std::vector<HeldLength>& lengths, double kT) {
  const Eigen::MatrixXd weights = integral_weights(lengths);
  const HeldLength& end = lengths.back();
  std::vector<FreeEnergies> all;
  for (Eigen::Index i = 0; i < weights.rows(); ++i) {
    const HeldLength& at = lengths[static_cast<std::size_t>(i)];
    const Eigen::RowVectorXd way = weights.row(weights.rows() - 1) - weights.row(i);  // from here to the end
    double held = 0, squares = 0;
    for (Eigen::Index k = 0; k < way.size(); ++k) {
      const Estimate& tension = lengths[static_cast<std::size_t>(k)].tension;
      held += way[k] * tension.value;
      squares += std::pow(way[k] * tension.error, 2);
    }
    const double distribution = held - kT * std::log(at.weight.value / end.weight.value);
    const double error = &at == &end
                             ? 0
                             : std::sqrt(squares + std::pow(kT, 2) * (std::pow(relative(at.weight), 2) +
                                                                      std::pow(relative(end.weight), 2)));
    all.push_back({.at = at,
                   .held = {held, std::sqrt(squares)},
                   .distribution = {distribution, error},
                   .potential = {distribution + 2 * kT * std::log(at.length / end.length), error}});
  }
  return all;
}

double error_of_spacing(const std::vector<FreeEnergies>& all, double kT) {
  if (all.size() < kLengthsToJudge) return 0;
  std::vector<HeldLength> fewer;
  std::vector<double> before;
  for (std::size_t back = 0; back < all.size(); back += 2) {  // the longest, at which all are 0, stays
    const FreeEnergies& kept = all[all.size() - 1 - back];
    fewer.insert(fewer.begin(), kept.at);
    before.insert(before.begin(), kept.potential.value);
  }
  const std::vector<FreeEnergies> again = integrate_mean_force(fewer, kT);
  double most = 0;
  for (std::size_t k = 0; k < again.size(); ++k)
    most = std::max(most, std::abs(again[k].potential.value - before[k]));
  constexpr double kFourthOrder = 15;  // 2⁴ − 1
  return most / kFourthOrder;
}

}  // namespace taut
