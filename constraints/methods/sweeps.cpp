#include "constraints/methods/sweeps.hpp"

#include <fmt/format.h>

#include <limits>

#include "constraints/bond_algebra.hpp"

namespace taut {

std::vector<Option> SweepLimits::describe() {
  const Counts to_tolerance{sweeps == 0, "without method.sweeps"};
  return {{"tolerance",
           &tolerance,
           "relative bond error (of rattle |r·v|h/d², too) at which sweeps stop",
           {.range = kTolerances, .counts = to_tolerance}},
          {"max_sweeps",
           &max_sweeps,
           "sweeps after which a step has failed",
           {.range = {.min = 1}, .counts = to_tolerance}},
          {"sweeps", &sweeps, "more than 0: take just so many, whatever they leave", {.range = {.min = 0}}}};
}

double SweepLimits::promised_error() const {
  return sweeps > 0 ? std::numeric_limits<double>::infinity() : tolerance;
}

std::string SweepLimits::setting() const {
  return sweeps > 0 ? fmt::format("{} sweeps", sweeps) : fmt::format("tolerance {:g}", tolerance);
}

namespace {

struct Sweep {
  Residual met;                      // largest residual before the corrections of this sweep
  Failure failure = Failure::kNone;  // reason to stop sweeping
};

Sweep turned_too_far(int bond) {
  return {{.value = 1, .bond = bond}, Failure::kTurned};  // an error of about the whole length
}

SolveStats repeat(const SweepLimits& limits, Failure failure, auto&& sweep) {
  const bool fixed = limits.sweeps > 0;
  const int most = fixed ? limits.sweeps : limits.max_sweeps;
  SolveStats stats;
  while (stats.iterations < most) {
    ++stats.iterations;
    const Sweep done = sweep(fixed ? 0.0 : limits.tolerance);
    stats.max_residual = done.met.value;
    stats.worst_bond = done.met.bond;
    stats.failure = done.failure;
    if (!stats.converged() || (!fixed && done.met.value <= limits.tolerance)) return stats;
  }
  if (!fixed) stats.failure = failure;
  return stats;
}

}  // namespace

PositionSweeps::PositionSweeps(const System& sys, SweepLimits limits)
    : limits_(limits), r_old_(3, sys.all_bonds()) {}

SolveStats PositionSweeps::run(const System& sys, double h, State& s, Eigen::VectorXd& g) {
  for (int k = 0; k < sys.all_bonds(); ++k) {
    r_old_.col(k) = sys.along(sys.bond(k), s.x) - h * sys.difference(sys.bond(k), s.v);
  }
  add_constraint_acceleration(sys, r_old_, g, s.x);

  const SolveStats stats = repeat(limits_, Failure::kNoConvergence, [&](double tolerance) {
    Residual residual;
    for (int k = 0; k < sys.all_bonds(); ++k) {
      const double d = sys.bond(k).length;
      const Vec3 r = sys.along(sys.bond(k), s.x);
      const double sigma_k = sigma(r, d), error = std::abs(sigma_k) / (d * d);
      const int side = sys.side(k);
      if (side * sigma_k > 0 && g[k] == 0) continue;  // slack
      residual.see(error, k);
      if (error <= tolerance) continue;
      const double along = r.dot(r_old_.col(k));
      if (!(along > 1e-6 * d * d)) return turned_too_far(k);
      double dg = -sigma_k / (sys.reduced_inv_mass(sys.bond(k)) * along);
      if (side != 0) dg = one_sided(side, g[k] + dg) - g[k];
      add_constraint_acceleration(sys, k, dg * r_old_.col(k), s.x);
      g[k] += dg;
    }
    return Sweep{residual};
  });
  for (int k = 0; k < sys.all_bonds(); ++k) {
    add_constraint_acceleration(sys, k, g[k] / h * r_old_.col(k), s.v);
  }
  return stats;
}

VelocitySweeps::VelocitySweeps(const System& sys, SweepLimits limits)
    : limits_(limits), r_(3, sys.all_bonds()), inv_a_kk_(sys.all_bonds()) {}

SolveStats VelocitySweeps::run(const System& sys, double h, State& s, const Eigen::VectorXd& held,
                               Eigen::VectorXd& g) {
  bond_vectors(sys, s.x, r_);
  for (int k = 0; k < sys.all_bonds(); ++k) {
    inv_a_kk_[k] = 1 / (sys.reduced_inv_mass(sys.bond(k)) * r_.col(k).squaredNorm());
  }
  for (int k = sys.bond_count(); k < sys.all_bonds(); ++k)
    if (held[k] == 0) r_.col(k).setZero();
  add_constraint_acceleration(sys, r_, g, s.v);

  return repeat(limits_, Failure::kVelocitiesNoConvergence, [&](double tolerance) {
    Residual residual;
    for (int k = 0; k < sys.all_bonds(); ++k) {
      const double d = sys.bond(k).length;
      const double rate = r_.col(k).dot(sys.difference(sys.bond(k), s.v)),
                   error = std::abs(rate) * h / (d * d);
      if (sys.side(k) * rate > 0 && g[k] == 0) continue;  // parting
      residual.see(error, k);
      if (error <= tolerance) continue;
      double dg = -rate * inv_a_kk_[k];
      if (sys.side(k) != 0) dg = one_sided(sys.side(k), g[k] + dg) - g[k];
      add_constraint_acceleration(sys, k, dg * r_.col(k), s.v);
      g[k] += dg;
    }
    return Sweep{residual};
  });
}

}  // namespace taut
