#include "measures/mean_force.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace taut {
namespace {

// Row i: what each value weighs in the integral from the i-th place to the last. Gauss's two points integrate a cubic
// exactly.
Eigen::MatrixXd weights_to_end(const std::vector<HeldLength>& at) {
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
  return weights.row(n - 1).replicate(n, 1) - weights;
}

using Kept = std::vector<std::size_t>;  // which of all lengths, ascending

// Both ends stay, of the others every other.
Kept every_other(const Kept& of, bool from_longest) {
  Kept kept;
  for (std::size_t k = 0; k < of.size(); ++k)
    if (k == 0 || k + 1 == of.size() || (from_longest ? of.size() - 1 - k : k) % 2 == 0)
      kept.push_back(of[k]);
  return kept;
}

// Row k: what the tension at each of all lengths weighs in the integral from the k-th of those kept to the longest.
Eigen::MatrixXd weights_of(const std::vector<HeldLength>& lengths, const Kept& kept) {
  std::vector<HeldLength> at;
  for (const std::size_t k : kept) at.push_back(lengths[k]);
  Eigen::MatrixXd of_all = Eigen::MatrixXd::Zero(std::ssize(kept), std::ssize(lengths));
  of_all(Eigen::all, kept) = weights_to_end(at);
  return of_all;
}

// What the integral over fewer lengths differs by, at most, beyond what the tensions' errors explain.
double change(const std::vector<HeldLength>& lengths, const Kept& more, const Kept& fewer) {
  constexpr double kStandardErrors = 2;
  const Eigen::MatrixXd of_more = weights_of(lengths, more), of_fewer = weights_of(lengths, fewer);
  double most = 0;
  for (std::size_t row = 0; row < fewer.size(); ++row) {
    const auto same = std::ranges::find(more, fewer[row]) - more.begin();
    const Eigen::RowVectorXd weights = of_fewer.row(static_cast<Eigen::Index>(row)) - of_more.row(same);
    double sum = 0, squares = 0;
    for (std::size_t k = 0; k < lengths.size(); ++k) {
      const double weight = weights[static_cast<Eigen::Index>(k)];
      sum += weight * lengths[k].tension.value;
      squares += std::pow(weight * lengths[k].tension.error, 2);
    }
    most = std::max(most, std::abs(sum) - kStandardErrors * std::sqrt(squares));
  }
  return most;
}

double relative(const Estimate& e) {
  return e.error / e.value;
}

}  // namespace

std::vector<FreeEnergies> integrate_mean_force(const std::vector<HeldLength>& lengths, double kT) {
  const Eigen::MatrixXd weights = weights_to_end(lengths);
  const HeldLength& end = lengths.back();
  std::vector<FreeEnergies> all;
  for (Eigen::Index i = 0; i < weights.rows(); ++i) {
    const HeldLength& at = lengths[static_cast<std::size_t>(i)];
    const Eigen::RowVectorXd way = weights.row(i);  // from here to the end
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

std::optional<double> error_of_spacing(const std::vector<HeldLength>& lengths) {
  if (lengths.size() < kLengthsToJudge) return {};
  Kept all(lengths.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  double most = 0;
  for (const bool from_longest : {true, false}) {
    const Kept half = every_other(all, from_longest), quarter = every_other(half, from_longest);
    const double by_half = change(lengths, all, half), by_quarter = change(lengths, half, quarter);
    if (by_half <= 0) continue;
    const double grows = std::clamp(by_quarter / by_half, 2.0, 16.0);  // 2⁴: of the fourth order
    most = std::max(most, by_half / (grows - 1));
  }
  return most;
}

}  // namespace taut
