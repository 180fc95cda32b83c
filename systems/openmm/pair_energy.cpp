#include "systems/openmm/pair_energy.hpp"

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <vector>

namespace taut {
namespace {

using Numbers = Eigen::Array<double, 5, 1>;

Numbers powers(double x) {
  const double u = std::pow(x, -6);
  return {u * u, -u, 1 / x, x * x, 1};
}

std::vector<double> places(bool without_end) {  // in units of the reach
  std::vector<double> all = {1e-3, 0.02, 0.1, 0.2,  0.3,  0.37, 0.43, 0.5,
                             0.57, 0.63, 0.7, 0.77, 0.83, 0.9,  0.96, 0.999};
  if (without_end) all.insert(all.end(), {2, 5});
  return all;
}

// Least squares over these places, each equation in units of what it adds up; the numbers of the round before say what
// that is. As all equations hold, units decide about rounding errors alone.
Numbers solve(const std::function<double(double)>& energy, const std::vector<double>& at,
              const Numbers& scale) {
  Eigen::MatrixXd terms(std::ssize(at), 5);
  Eigen::VectorXd sums(std::ssize(at));
  for (Eigen::Index row = 0; row < sums.size(); ++row) {
    const double x = at[static_cast<std::size_t>(row)];
    const Numbers scaled = powers(x) * scale;
    const double unit = scaled.abs().sum();
    terms.row(row) = scaled.matrix() / unit;
    sums[row] = energy(x) / unit;
  }
  return terms.householderQr().solve(sums).array() * scale;
}

}  // namespace

std::optional<PairEnergy> PairEnergy::of(const std::function<double(double)>& energy,
                                         std::optional<double> reach) {
  const double unit = reach.value_or(1);
  const auto in_units = [&](double x) { return energy(x * unit); };
  const std::vector<double> at = places(!reach);
  Numbers found = Numbers::Ones();
  for (int round = 0; round < 4; ++round) {
    const Numbers scale = (found != 0).select(found.abs(), 1e-30);
    found = solve(in_units, at, scale);
    if (!found.isFinite().all()) return {};
    Numbers most = Numbers::Zero();  // share of what is added up
    for (const double x : at) {
      if (x < 0.1) continue;  // where one power drowns all others
      const Numbers parts = (powers(x) * found).abs();
      if (parts.sum() > 0) most = most.max(parts / parts.sum());
    }
    found = (most < 1e-11).select(0, found);
  }
  const double u = std::pow(unit, 6);
  const PairEnergy law{found[0] * u * u, found[1] * u, found[2] * unit, found[3] / (unit * unit), found[4]};
  for (const double share : {0.017, 0.08, 0.15, 0.23, 0.31, 0.35, 0.41, 0.47, 0.55, 0.66, 0.81, 0.93}) {
    const Expression::Rough here = law.at(share * unit);
    if (!(std::abs(in_units(share) - here.value) <= here.error)) return {};
  }
  return law;
}

Expression::Rough PairEnergy::at(double r) const {
  const Numbers parts = powers(r) * Numbers{a, b, q, k, e};
  return {parts.sum(), 1e-9 * parts.abs().sum()};
}

}  // namespace taut
