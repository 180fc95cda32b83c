#include "ensembles/bussi.hpp"

#include <cmath>

#include "md/observables.hpp"
#include "md/units.hpp"

namespace taut {
namespace {

// The sum of the squares of n normal numbers. Half of it has the gamma distribution of shape n/2 (Marsaglia
// and Tsang 2000, doi:10.1145/358407.358414).
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

VelocityRescaling::VelocityRescaling(const System& sys, const Settings& settings)
    : settings_(settings), drift_(sys), random_{settings.seed} {}

double VelocityRescaling::next_scale(double kinetic, double h) {
  const double c = std::exp(-h / settings_.relaxation);
  const double share = 0.5 * kBoltzmann * settings_.temperature / kinetic;  // K̄/n over K
  RandomOfStep random = random_.next(Stream::kRescaling);
  const double first = random.normal();
  const double squares = first * first + sum_of_squares(settings_.dof - 1, random);
  return std::max(0.0, c + share * (1 - c) * squares + 2 * first * std::sqrt(c * (1 - c) * share));
}

double VelocityRescaling::after_step(const System& sys, double h, State& s) {
  const Vectors& u = drift_.of(h, s);
  const double kinetic = kinetic_energy(sys, u);
  if (kinetic == 0) return 0;
  const double more = std::sqrt(next_scale(kinetic, h)) - 1;
  const double along =  // Σ m v·u
      (s.v.cwiseProduct(u).colwise().sum().transpose().array() * sys.mass.array()).sum();
  s.v += more * u;
  return more * along + more * more * kinetic;
}

}  // namespace taut
