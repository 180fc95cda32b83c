#pragma once

#include <functional>

#include "constraints/bond_algebra.hpp"
#include "constraints/projection.hpp"
#include "constraints/registry.hpp"
#include "md/observables.hpp"

namespace taut::tests {

// What one run showed of a method, every step looked at.
struct Verdict {
  double bond_error = 0;  // largest relative error of a bond length
  double predicted_error =
      0;  // largest relative error that one step's truncation feeds: h³|v·a|/(2d²) + h⁴a²/(8d²)
  double fed_error = 0;        // its even part, h⁴a²/(8d²), which alone adds up
  double turn = 1;             // smallest cosine between a bond before and after a step
  double momentum_change = 0;  // relative to Σ m|v|
  double energy_change = 0;    // |E − E₀| at the end, of the largest kinetic energy on the way
  State end;
  Eigen::VectorXd lambda;
  SolveStats stats;
};

// Runs `steps` steps from a start that is first brought to the bonds. `potential`: the energy of the forces,
// where they have one [kJ/mol].
inline Verdict verify(const System& sys, ForceLaw& forces, const MethodOptions& options, double h, int steps,
                      State s, const std::function<double(State)>& potential = {}) {
  Verdict verdict;
  const auto method = make_method(sys, options, h);
  const Dynamics dynamics{sys, forces, *method};
  initialize(dynamics, h, s);
  const Vec3 momentum_before = momentum(sys, s.v);
  const auto energy = [&] {
    return kinetic_energy(sys, s.v) + (potential ? potential(s) : 0.0) + method->spring_energy(sys, s.x);
  };
  const double energy_before = energy();
  double largest_kinetic = kinetic_energy(sys, s.v);
  const double scale = (s.v.colwise().norm() * sys.mass).value() + 1e-300;
  Vectors r(3, sys.bond_count()), r_before(3, sys.bond_count());
  differences(sys, s.x, r_before);
  for (int n = 0; n < steps; ++n) {
    const Vectors v_before = s.v;
    verdict.stats += step(dynamics, h, s);
    if (!verdict.stats.converged()) break;
    differences(sys, s.x, r);
    for (int k = 0; k < sys.bond_count(); ++k) {
      const auto& [i, j, d] = sys.bonds[k];
      const Vec3 v = s.v.col(j) - s.v.col(i), a = (v - (v_before.col(j) - v_before.col(i))) / h;
      verdict.predicted_error = std::max(
          verdict.predicted_error,
          (std::pow(h, 3) * v.norm() * a.norm() / 2 + std::pow(h, 4) * a.squaredNorm() / 8) / (d * d));
      verdict.fed_error = std::max(verdict.fed_error, std::pow(h, 4) * a.squaredNorm() / (8 * d * d));
      verdict.turn = std::min(verdict.turn, r.col(k).normalized().dot(r_before.col(k).normalized()));
    }
    r_before = r;
    largest_kinetic = std::max(largest_kinetic, kinetic_energy(sys, s.v));
    const double error = bond_errors(sys, s.x).max;
    if (exceeds(error, verdict.bond_error)) verdict.bond_error = error;
  }
  verdict.momentum_change = (momentum(sys, s.v) - momentum_before).norm() / scale;
  verdict.energy_change = std::abs(energy() - energy_before) / largest_kinetic;
  verdict.lambda = method->lambda();
  verdict.end = std::move(s);
  return verdict;
}

template <class Options>
MethodOptions tight() {
  Options options;
  options.tolerance = 1e-14;
  return options;
}

}  // namespace taut::tests
