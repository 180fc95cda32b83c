#include "md/observables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/exceeds.hpp"
#include "base/shares.hpp"
#include "md/units.hpp"

namespace taut {

double kinetic_energy(const System& sys, const Vectors& v) {
  return 0.5 * (v.colwise().squaredNorm().transpose().array() * sys.mass.array()).sum();
}

Vec3 momentum(const System& sys, const Vectors& v) {
  return v * sys.mass;
}

void remove_momentum(const System& sys, Vectors& v) {
  struct Sums {
    Vec3 momentum;
    double mass;
  };
  constexpr int kMostThreads = 64;
  std::array<Sums, kMostThreads> of_thread;
  const int atoms = sys.atoms(), threads = std::min(threads_for(atoms, kAtomsOfShortWork), kMostThreads);
  in_parallel(threads, [&](int t) {
    const Share share(atoms, t, threads);
    const int count = share.end - share.begin;
    const auto mass = sys.mass.segment(share.begin, count);
    of_thread[t] = {v.middleCols(share.begin, count) * mass, mass.sum()};
  });
  Sums sum = of_thread[0];
  for (int t = 1; t < threads; ++t) sum.momentum += of_thread[t].momentum, sum.mass += of_thread[t].mass;
  if (sum.mass == 0) return;
  const Vec3 drift = sum.momentum / sum.mass;
  by_atoms(atoms, [&](int first, int last) {
    for (int i = first; i < last; ++i)
      if (sys.mass[i] > 0) v.col(i) -= drift;
  });
}

DegreesOfFreedom degrees_of_freedom(const System& sys, int rank, int fixed) {
  return {static_cast<int>((sys.mass.array() > 0).count()), rank, fixed};
}

std::string DegreesOfFreedom::sum() const {
  return fmt::format("3·{} − {}{} = {}", mobile, rank, fixed > 0 ? fmt::format(" − {}", fixed) : "", total());
}

double temperature(double kinetic, int dof) {
  return dof > 0 ? 2 * kinetic / (dof * kBoltzmann) : 0.0;
}

BondErrors bond_errors(const System& sys, const Vectors& x) {
  BondErrors e;
  double sum = 0;
  for (int k = 0; k < sys.all_bonds(); ++k) {
    const auto& [i, j, d] = sys.bond(k);
    const double off = sys.along(sys.bond(k), x).norm() - d;
    if (sys.side(k) * off > 0) continue;  // slack
    const double error = std::abs(off) / d;
    if (k < sys.bond_count()) sum += error * error;
    if (exceeds(error, e.max)) {
      e.max = error;
      e.worst = k;
    }
  }
  if (sys.bond_count() > 0) e.rms = std::sqrt(sum / sys.bond_count());
  return e;
}

}  // namespace taut
