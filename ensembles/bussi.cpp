#include "ensembles/bussi.hpp"

#include <cmath>

#include "md/units.hpp"

namespace taut {
namespace {

// The sum of the squares of n normal numbers. Half of it has the gamma distribution of shape n/2 (Marsaglia and
// Tsang 2000, doi:10.1145/358407.358414).
double sum_of_squares(int n, RandomOfStep& random) {
  if (n < 4) {
    double sum = 0;
    for (int k = 0; k < n; ++k) {
      const double r = random.normal();
      sum += r * r;
    }
    return sum;
  }
  const double d = 0.5 * n - 1.0 / 3, c = 1 / std::sqrt(9 * d);
  while (true) {
    const double x = random.normal(), cube = std::pow(1 + c * x, 3);
    if (cube > 0 && std::log(random.uniform()) < 0.5 * x * x + d * (1 - cube + std::log(cube)))
      return 2 * d * cube;
  }
}

}  // namespace

VelocityRescaling::VelocityRescaling(double temperature, double relaxation, int dof, std::uint64_t seed)
    : target_(0.5 * dof * kBoltzmann * temperature), relaxation_(relaxation), dof_(dof), random_{seed} {}

double VelocityRescaling::operator()(double kinetic, double h, Vectors& v) {
  if (kinetic == 0) return 1;
  const double c = std::exp(-h / relaxation_), share = target_ / dof_ / kinetic;
  RandomOfStep random = random_.next(Stream::kRescaling);
  const double first = random.normal();
  const double squares = first * first + sum_of_squares(dof_ - 1, random);
  const double scale =
      std::max(0.0, c + share * (1 - c) * squares + 2 * first * std::sqrt(c * (1 - c) * share));
  v *= std::sqrt(scale);
  return scale;
}

}  // namespace taut
